"""File, Share: the window's scene as one file, made beside the window."""

import json
import re
from base64 import b64decode
from datetime import timedelta
from gzip import decompress

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog
from share import page_file
from share.page_file import SCRIPT
from window_driver import NOON

from vrut_lite.kernel.messages import SetClock
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import SunMoved
from vrut_lite.messages.tolerance import SetTolerance
from vrut_lite.project import CameraView


@pytest.fixture
def driver(headless_window, tmp_path, monkeypatch):
    """A window whose file dialog answers `driver.answer`."""
    driver = headless_window
    driver.answer = str(tmp_path / "sundial")

    def chosen(parent, title, name, kinds):
        assert name.endswith(".html")
        return driver.answer, ""

    monkeypatch.setattr(QFileDialog, "getSaveFileName", chosen)
    return driver


def asked(driver):
    """The panel, after File, Share."""
    driver.window.actions_by_name["panel light_transport.share"].trigger()
    return driver.window.panels["panel light_transport.share"]


def test_file_has_an_entry_before_quit(driver):
    """As export has one: who does not know the panel finds it."""
    (menu,) = [m for m in driver.window.menuBar().actions() if m.text() == "&File"]
    titles = [a.text().replace("&", "") for a in menu.menu().actions()]
    assert titles[-2:] == ["Share in one file\N{HORIZONTAL ELLIPSIS}", "Quit"]


def test_what_cannot_be_written_is_said_before_the_work(driver, tmp_path, monkeypatch):
    """Another ending, a folder that is missing, a script that is not built: in the dialog."""
    built = tmp_path / "page.js"
    built.write_text("// built", encoding="utf-8")
    monkeypatch.setattr(page_file, "SCRIPT", built)
    for answer, said in (
        (tmp_path / "page.png", "a page's name ends with .html"),
        (tmp_path / "missing" / "page.html", "missing"),
    ):
        driver.answer = str(answer)
        assert not asked(driver).is_running
        assert said in driver.window.files.refused.lines[-1]
    monkeypatch.setattr(page_file, "SCRIPT", tmp_path / "none.js")
    asked(driver)
    assert "the page's script is not built" in driver.window.files.refused.lines[-1]


def test_a_page_that_is_given_up_leaves_no_file(driver, tmp_path, qtbot):
    if not SCRIPT.is_file():
        pytest.skip("needs Node.js with npm: sh tools/bootstrap.sh page")
    panel = asked(driver)
    assert panel.is_running
    assert panel.cancel.isVisible()
    qtbot.mouseClick(panel.cancel, Qt.MouseButton.LeftButton)
    assert not panel.is_running
    assert panel.result.text() == "Stopped: sundial.html was not written."
    assert not list(tmp_path.glob("*.html"))
    assert panel.share.isEnabled()


def numbers_in(folder, height_m):
    """What `vrut-lite daylight` writes: two sensors of a plane."""
    folder.mkdir()
    (folder / "sensors.csv").write_text(
        "plane,x_m,y_m,z_m,direction_x,direction_y,direction_z,daylight_factor_percent\n"
        f"floor,0,{height_m},0,0,1,0,2\nfloor,0.5,{height_m},0,0,1,0,4\n",
        encoding="utf-8",
    )
    return folder


def test_numbers_that_are_not_the_scenes_are_refused_before_the_work(
    driver, tmp_path, qtbot, monkeypatch
):
    """A folder without a table, and a table of another scene; the field keeps what was chosen."""
    built = tmp_path / "page.js"
    built.write_text("// built", encoding="utf-8")
    monkeypatch.setattr(page_file, "SCRIPT", built)
    panel = driver.window.panels["panel light_transport.share"]
    for folder, said in (
        (tmp_path, "has no readable sensors.csv"),
        (numbers_in(tmp_path / "elsewhere", 9e3), "is of another scene"),
    ):
        monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_, f=folder: str(f))
        qtbot.mouseClick(panel.choose, Qt.MouseButton.LeftButton)
        assert panel.numbers.text() == str(folder)
        assert not asked(driver).is_running
        assert said in driver.window.files.refused.lines[-1]


@pytest.mark.long
def test_the_windows_scene_is_shared_while_the_window_goes_on(driver, tmp_path, monkeypatch):
    """Its place, hour, haze and views by name are in the page, whose size is told."""
    if not SCRIPT.is_file():
        pytest.skip("needs Node.js with npm: sh tools/bootstrap.sh page")
    view = CameraView(eye_m=(3.0, 1.7, 3.0), target_m=(0.0, 0.5, 0.0))
    driver.window.files.views.keep("from the door", view)
    driver.session.send(
        SetPlace(latitude_deg=46.6, longitude_deg=8.0, altitude_m=560.0),
        SetTolerance(tolerance=0.3),
        SetHaze(optical_depth_550=0.3),
    )
    driver.settled()
    driver.window.panels["panel light_transport.share"].numbers.setText(
        str(numbers_in(tmp_path / "numbers", 0.5))
    )
    panel = asked(driver)
    # The window goes on: another hour is shown before the page is made.
    driver.session.send(SetClock(instant=NOON + timedelta(hours=2)))
    driver.until_heard(SunMoved)
    assert panel.is_running
    seen = set()
    while panel.is_running:
        driver.qtbot.wait(50)
        seen.add(panel.work.text())
    assert driver.window.files.refused.lines == []
    assert any("sun's places" in text for text in seen)
    path = tmp_path / "sundial.html"
    assert panel.result.text().startswith(f"{path}: {path.stat().st_size / 1e6:.1f} MB")
    data = decompress(b64decode(re.search(r'id="data">([^<]*)<', path.read_text())[1]))
    header = json.loads(data[4 : 4 + int.from_bytes(data[:4], "little")])
    assert header["place"]["latitude_deg"] == 46.6
    assert header["start"].startswith("2026-06-21T")
    assert header["numbers"]["names"] == ["daylight factor"]
    assert header["views"]["from the door"]["eye_m"] == [3.0, 1.7, 3.0]
    opened = []
    monkeypatch.setattr(QDesktopServices, "openUrl", opened.append)
    panel.open.click()
    assert opened[0].toLocalFile() == str(path)

"""Examples, manual and facts of the installation, from the menus."""

from pathlib import Path

import pytest
from PySide6.QtGui import QDesktopServices, QGuiApplication
from PySide6.QtWidgets import QFileDialog
from window_driver import PATIENCE_MS

from vrut_lite import __version__
from vrut_lite.app.engine.session_project import folder_of
from vrut_lite.app.window.about_box import AboutBox
from vrut_lite.app.window.manual_window import ManualWindow
from vrut_lite.bundled import places
from vrut_lite.bundled.examples import all_examples, example_named
from vrut_lite.messages.scene import SceneOpened


@pytest.fixture
def driver(shared_headless_window):
    return shared_headless_window


def test_an_example_is_opened_from_the_menu(driver, qtbot):
    """All scenes stand there by their titles; a click opens one."""
    menus = driver.window.menus
    menus.examples.aboutToShow.emit()
    scenes = [example for example in all_examples().values() if example.kind == "scene"]
    entries = menus.examples.actions()
    assert [entry.text() for entry in entries] == [scene.title for scene in scenes]
    spheres = next(entry for entry in entries if entry.text() == "Balls of ten materials")
    spheres.trigger()
    qtbot.waitUntil(
        lambda: driver.session.last(SceneOpened).path.endswith("spheres.glb"), timeout=PATIENCE_MS
    )


def test_what_is_saved_from_an_example_goes_to_the_users_documents(driver, monkeypatch):
    """Beside an installed example the next upgrade would remove it."""
    scene = Path(driver.session.last(SceneOpened).path).resolve()
    assert Path(folder_of(driver.session)) == scene.parent
    monkeypatch.setattr(places, "DATA", scene.parents[1])
    assert not Path(folder_of(driver.session)).is_relative_to(scene.parents[1])


def test_an_example_is_not_saved_over(driver, monkeypatch, tmp_path):
    """The installed file is shared by all; its copy is saved where the user says."""
    street = example_named("street").opens
    monkeypatch.setattr(places, "DATA", street.parents[1])
    driver.window.files.open_path(str(street))
    assert driver.window.files.project is None
    proposed = []
    chosen = tmp_path / "mine"
    monkeypatch.setattr(
        QFileDialog, "getSaveFileName", lambda *said: proposed.append(said[2]) or (str(chosen), "")
    )
    driver.window.files.ask_to_save()
    assert not Path(proposed[0]).is_relative_to(street.parents[1])
    assert proposed[0].endswith(".vrut.toml")
    assert chosen.with_suffix(".vrut.toml").is_file()


def test_the_manual_opens_in_the_browser(driver, monkeypatch):
    """With the start page of this installation."""
    opened = []
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: opened.append(url) or True)
    driver.window.actions_by_name["manual"].trigger()
    (url,) = opened
    assert Path(url.toLocalFile()).name == "index.html"
    assert Path(url.toLocalFile()).is_file()
    assert not driver.window.findChildren(ManualWindow)


def test_without_a_browser_the_manual_opens_in_a_window(driver, monkeypatch):
    """Its links lead to the other pages there."""
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: False)
    driver.window.actions_by_name["manual"].trigger()
    (manual,) = driver.window.findChildren(ManualWindow)
    assert "renders scenes in daylight" in manual.page.toPlainText()
    manual.page.setSource(manual.page.source().resolved("app.html"))
    assert "The desktop application" in manual.page.toPlainText()
    manual.close()


def test_the_facts_for_a_bug_report_are_shown_and_copied(driver, qtbot):
    """One button puts them on the clipboard."""
    driver.window.actions_by_name["about"].trigger()
    qtbot.waitUntil(lambda: driver.window.findChildren(AboutBox) != [], timeout=PATIENCE_MS)
    (box,) = driver.window.findChildren(AboutBox)
    box.copies.click()
    copied = QGuiApplication.clipboard().text()
    assert copied == box.text
    assert copied.startswith(f"vrut_lite {__version__}, ")
    assert "graphics: none" in copied
    assert "Qt 6." in copied
    box.close()

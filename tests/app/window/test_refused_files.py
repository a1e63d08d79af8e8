"""Files that are refused: a text that stays, and that one can select and copy."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QFileDialog

from vrut_lite.kernel.messages import SetSetting


@pytest.fixture
def driver(shared_headless_window):
    yield shared_headless_window
    shared_headless_window.window.files.refused.close()


def test_several_refused_files_are_told_in_one_dialog(driver, tmp_path):
    """A project, a scene and a year of weather, a sentence each; nothing waits for it."""
    refused = driver.window.files.refused
    names = ("broken.toml", "broken.glb", "broken.epw")
    for name in names:
        (tmp_path / name).write_bytes(b"no such thing")
    driver.window.files.open_path(str(tmp_path / names[0]))
    assert refused.isVisible()
    assert not refused.isModal()
    driver.window.files.open_path(str(tmp_path / names[1]))
    driver.until(lambda: len(refused.lines) == 2)
    driver.window.files.open_weather(str(tmp_path / names[2]))
    driver.until(lambda: len(refused.lines) == 3)
    said = refused.text.toPlainText()
    assert all(name in said for name in names)
    assert refused.heading.text() == "3 files were refused:"
    driver.click(refused.copy)
    assert QGuiApplication.clipboard().text() == said
    selectable = refused.text.textInteractionFlags()
    assert selectable & Qt.TextInteractionFlag.TextSelectableByMouse
    driver.click(refused.dismiss)
    assert not refused.isVisible()
    driver.window.files.open_path(str(tmp_path / names[0]))
    assert len(refused.lines) == 1


def test_a_broken_journal_is_told_there_too(driver, tmp_path, monkeypatch):
    """The status line's sentence is gone after twelve seconds."""
    path = tmp_path / "broken.mcap"
    path.write_bytes(b"no journal")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    driver.window.show_dock("messages")
    driver.click(driver.panel("messages").journal.open)
    driver.until(lambda: "broken.mcap" in driver.window.files.refused.said)


def test_a_refused_setting_that_names_no_file_opens_no_dialog(driver):
    """A number out of range is told by the status line alone."""
    driver.session.send(SetSetting(module="scene", name="section_at", value=7.0))
    driver.until(lambda: bool(driver.problems))
    assert not driver.window.files.refused.isVisible()


def test_a_file_of_a_setting_is_chosen_by_its_button(driver, tmp_path, monkeypatch):
    """The panorama of the photograph; one that cannot be read is refused in the dialog."""
    path = tmp_path / "broken.exr"
    path.write_bytes(b"no picture")
    asked = []
    monkeypatch.setattr(
        QFileDialog, "getOpenFileName", lambda *call: asked.append(call) or (str(path), "")
    )
    row = driver.panel("sky").panels["photo_sky"].rows["photo"]
    row.editor.browse.click()
    assert "*.exr" in asked[0][3]
    driver.until(lambda: row.editor.text() == str(path))
    driver.until(lambda: driver.session.catalogue.modules["photo_sky"].values["photo"] == str(path))
    driver.window.undo()
    driver.until(lambda: row.editor.text() == "")

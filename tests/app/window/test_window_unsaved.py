"""Ctrl+S saves; the title says whether there is something to save, and who leaves is asked."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog, QMessageBox
from window_driver import NOON, SCENES

from vrut_lite.kernel.messages import SetClock, SetSetting
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.project import CameraView, Project, load_project, save_project

CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


@pytest.fixture
def driver(shared_headless_window, tmp_path):
    """A window with a named project, as its file has it."""
    driver = shared_headless_window.activated()
    driver.path = tmp_path / "evening.toml"
    save_project(driver.path, Project(scene=str(SCENES / "sundial.glb"), at=NOON.isoformat()))
    driver.window.files.open_path(str(driver.path))
    driver.until(lambda: "evening.toml" in driver.window.windowTitle())
    settle(driver)
    yield driver
    driver.window.files.project = None


def settle(driver):
    """Let what was sent be acted on, and be looked at."""
    driver.settled()
    driver.settled()
    driver.window.files.unsaved.look()


def send(driver, *messages):
    driver.session.send(*messages)
    settle(driver)


def brighter(value=0.4):
    return SetSetting(module="dynamic_skylight", name="albedo", value=value)


def answer(driver, button):
    """Press a button of the question on unsaved changes."""
    driver.until(lambda: driver.window.files.question is not None)
    driver.click(driver.window.files.question.button(button))
    driver.until(lambda: driver.window.files.question is None)


def test_the_title_is_marked_while_there_is_something_to_save(driver):
    """A setting or an hour is; undone it is not, and neither is a look around."""
    window = driver.window
    assert not window.isWindowModified()
    send(driver, MoveCamera(eye_m=(5.0, 6.0, 7.0), target_m=(0.0, 1.0, 0.0)))
    send(driver, Resize(width_px=80, height_px=60))
    assert not window.isWindowModified()
    send(driver, brighter())
    assert window.isWindowModified()
    window.undo()
    settle(driver)
    assert not window.isWindowModified()
    send(driver, SetClock(instant=NOON.replace(hour=9)))
    assert window.isWindowModified()
    driver.until(lambda: "[*]" in window.windowTitle())


def test_views_that_are_kept_are_to_be_saved_too(driver):
    """They stand in the project alone."""
    files = driver.window.files
    files.views.keep("gate", CameraView(eye_m=(1.0, 2.0, 3.0), target_m=(0.0, 0.0, 0.0)))
    files.unsaved.look()
    assert driver.window.isWindowModified()
    files.views.forget("gate")
    files.unsaved.look()
    assert not driver.window.isWindowModified()


def test_ctrl_s_saves_without_a_question_and_ctrl_shift_s_asks_for_a_name(driver, monkeypatch):
    """The file has the change, and the mark is gone; the project is that of the new name."""
    asked = []
    other = driver.path.with_name("morning.toml")
    monkeypatch.setattr(
        QFileDialog, "getSaveFileName", lambda *_: asked.append(1) or (str(other), "")
    )
    send(driver, brighter())
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_S, CONTROL)
    assert load_project(driver.path).settings == {"dynamic_skylight": {"albedo": 0.4}}
    assert not driver.window.isWindowModified()
    assert asked == []
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_S, CONTROL | SHIFT)
    assert asked == [1]
    assert driver.window.files.project == other
    assert other.is_file()


def test_without_a_name_saving_asks_for_one(driver, monkeypatch):
    """As the first time in every application."""
    driver.window.files.project = None
    other = driver.path.with_name("new.toml")
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(other), ""))
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_S, CONTROL)
    assert other.is_file()


def test_closing_asks_where_a_named_project_has_changes(driver):
    """Cancel keeps the window; nothing blocks meanwhile."""
    send(driver, brighter())
    driver.window.close()
    assert driver.window.isVisible()
    answer(driver, QMessageBox.StandardButton.Cancel)
    assert driver.window.isVisible()
    assert load_project(driver.path).settings == {}


def test_another_scene_waits_for_the_answer(driver):
    """Saved or given up: only then the next one opens."""
    send(driver, brighter())
    driver.heard.clear()
    driver.window.files.ask_and_open(str(SCENES / "spheres.glb"))
    driver.settled()
    assert not any(isinstance(message, SceneOpened) for message in driver.heard)
    answer(driver, QMessageBox.StandardButton.Save)
    driver.until_heard(SceneOpened, lambda m: m.path.endswith("spheres.glb"))
    assert load_project(driver.path).settings == {"dynamic_skylight": {"albedo": 0.4}}
    assert driver.window.files.project is None
    settle(driver)
    driver.until(lambda: not driver.window.isWindowModified())


def test_what_has_no_name_is_left_without_a_question(driver):
    """The last session comes back by itself."""
    driver.window.files.project = None
    send(driver, brighter())
    left = []
    driver.window.files.leave(lambda: left.append(1))
    assert left == [1]
    assert driver.window.files.question is None


def test_closing_ends_the_window_once_changes_are_given_up(headless_window, tmp_path):
    """The file stays as it was."""
    driver, path = headless_window, tmp_path / "evening.toml"
    driver.window.files.save(str(path))
    before = path.read_text()
    send(driver, brighter())
    driver.window.close()
    answer(driver, QMessageBox.StandardButton.Discard)
    driver.until(lambda: driver.session.has_ended)
    assert not driver.window.isVisible()
    assert path.read_text() == before

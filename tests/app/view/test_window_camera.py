"""The camera by mouse and keys, and files dropped on the picture."""

import math
import threading
import time

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent, QWheelEvent
from PySide6.QtWidgets import QApplication
from window_driver import SCENES, SMALL, HeadlessStage, WindowDriver, move_pointer

from vrut_lite.errors import GivenUp
from vrut_lite.kernel.messages import Tick
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.picture import Resize, SetExposure
from vrut_lite.messages.scene import SceneOpened


@pytest.fixture
def driver(shared_headless_window):
    window = shared_headless_window
    window.view = window.window.desk.viewport
    window.window.actions_by_name["orbit"].trigger()
    return window


def drag(qtbot, view, way, button=Qt.MouseButton.LeftButton):
    middle = view.rect().center()
    qtbot.mousePress(view, button, pos=middle)
    move_pointer(view, middle + way, button)
    qtbot.mouseRelease(view, button, pos=middle + way)


def wheel(view, steps):
    middle = QPointF(view.rect().center())
    event = QWheelEvent(
        middle, view.mapToGlobal(middle), QPoint(), QPoint(0, 120 * steps),
        Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier, Qt.ScrollPhase.NoScrollPhase,
        False,
    )  # fmt: skip
    QApplication.sendEvent(view, event)


def test_the_projects_camera_is_taken_over(driver):
    """The first drag begins where the project put the camera."""
    driver.until(lambda: np.allclose(driver.view.rig.eye_m, (1.5, 1.5, 3.4)))


def test_a_drag_turns_around_the_scene(driver, qtbot):
    """Distance and target stay, the direction changes; the kernel hears the camera."""
    target, distance_m = driver.view.rig.target_m, driver.view.rig.distance_m
    drag(qtbot, driver.view, QPoint(80, 0))
    camera = driver.until_heard(MoveCamera)
    assert np.allclose(camera.target_m, target)
    assert math.dist(camera.eye_m, camera.target_m) == pytest.approx(distance_m)
    assert not np.allclose(camera.eye_m, (1.5, 1.5, 3.4))


def test_a_drag_with_the_right_button_shifts(driver, qtbot):
    """Eye and target move alike."""
    eye, target = driver.view.rig.eye_m.copy(), driver.view.rig.target_m
    drag(qtbot, driver.view, QPoint(0, 60), Qt.MouseButton.RightButton)
    camera = driver.until_heard(MoveCamera)
    assert np.allclose(np.subtract(camera.eye_m, eye), np.subtract(camera.target_m, target))
    assert camera.eye_m[1] > eye[1]


def test_the_wheel_goes_nearer_zooms_or_climbs(driver, qtbot):
    """The mode of the mouse, chosen by the keys 1, 2 and 3, decides what the wheel does."""
    distance_m = driver.view.rig.distance_m
    wheel(driver.view, 2)
    assert driver.view.rig.distance_m < distance_m
    driver.window.actions_by_name["fly"].trigger()
    angle = driver.view.rig.field_of_view_rad
    wheel(driver.view, 2)
    assert driver.view.rig.field_of_view_rad < angle
    driver.window.actions_by_name["space"].trigger()
    for _ in range(60):
        wheel(driver.view, 2)
    driver.until_heard(MoveCamera, lambda m: m.eye_m[1] > 1e5)


def test_flying_by_keys_goes_on_while_they_are_held(driver, qtbot):
    """W flies forward along the view until it is let go."""
    driver.window.actions_by_name["fly"].trigger()
    driver.view.setFocus()
    eye, forward = driver.view.rig.eye_m.copy(), driver.view.rig.forward
    qtbot.keyPress(driver.view, Qt.Key.Key_W)
    driver.until(lambda: np.linalg.norm(driver.view.rig.eye_m - eye) > 0.05)
    qtbot.keyRelease(driver.view, Qt.Key.Key_W)
    way = driver.view.rig.eye_m - eye
    assert np.allclose(way / np.linalg.norm(way), forward)
    driver.until(lambda: not driver.view._flight.is_on)


class HeldStage(HeadlessStage):
    """Waits in the midst of a finished picture until the test has gone on.

    Tests of pieces (tests/render) hold that OpenGL gives its pictures up too.
    """

    reached, released = threading.Event(), threading.Event()

    def draw(self, state, still, is_given_up=None):
        if still:
            self.reached.set()
            self.released.wait()
            if is_given_up():
                raise GivenUp
        return super().draw(state, still)


@pytest.mark.long
def test_a_finished_picture_is_given_up_for_a_hand_that_moves_on(qtbot, tmp_path):
    """It takes seconds on a software renderer: after a drag or an undone step the next picture is
    a quick one, made at once, and a window that is closed shows none any more."""
    HeldStage.released.set()
    driver = WindowDriver(qtbot, HeldStage, tmp_path, SMALL)
    driver.session.send(SetExposure(compensation_ev=1.0))
    view, shown = driver.window.desk.viewport, []
    driver.session.picture_shown.connect(shown.append)
    for act in (lambda: drag(qtbot, view, QPoint(0, 40)), driver.window.undo, driver.window.close):
        HeldStage.released.clear()
        HeldStage.reached.clear()
        drag(qtbot, view, QPoint(40, 0))
        driver.until(HeldStage.reached.is_set)
        shown.clear()
        act()
        HeldStage.released.set()
        driver.until(lambda: driver.session.has_ended or (len(shown) > 0 and shown[-1].still))
        assert [picture.still for picture in shown[:1]] in ([False], [])
        assert driver.session.has_ended == (shown == [])
    driver.close()


class SlowStage(HeadlessStage):
    """A finished picture takes until it is given up, or a fifth of a second."""

    def draw(self, state, still, is_given_up=None):
        end_s = time.monotonic() + 0.2
        while still and time.monotonic() < end_s:
            if is_given_up():
                raise GivenUp
            time.sleep(0.005)
        return super().draw(state, still)


@pytest.mark.long
def test_what_changes_nothing_to_be_seen_gives_a_picture_up_once(qtbot, tmp_path):
    """Time that passes slowly tells so thirty times a second: were each a reason to begin anew, no
    picture would ever be finished."""
    driver = WindowDriver(qtbot, SlowStage, tmp_path)
    shown = []
    driver.session.picture_shown.connect(shown.append)
    for stops in (1.0, 2.0):
        shown.clear()
        driver.session.send(SetExposure(compensation_ev=stops))
        for _ in range(400):
            driver.session.send(Tick(elapsed_s=0.0))
            qtbot.wait(20)
            if shown and shown[-1].still:
                break
        assert shown[-1].still
    driver.close()


def test_keys_alone_turn_and_frame(driver, qtbot):
    """Arrows turn, F shows the whole scene, which lies in the picture then."""
    driver.view.setFocus()
    azimuth = driver.view.rig.azimuth_rad
    qtbot.keyClick(driver.view, Qt.Key.Key_Left)
    assert driver.view.rig.azimuth_rad != azimuth
    driver.window.actions_by_name["frame"].trigger()
    scene = driver.session.last(SceneOpened)
    middle = 0.5 * np.add(scene.lower_m, scene.upper_m)
    driver.until_heard(MoveCamera, lambda m: np.allclose(m.target_m, middle))


def test_the_picture_follows_the_windows_size(driver):
    """The picture takes the window's size in screen pixels once resizing has ended."""
    driver.window.resize(1000, 700)
    driver.until(lambda: driver.session.last(Resize) is not None)
    driver.until(
        lambda: (
            (driver.session.last(Resize).width_px, driver.session.last(Resize).height_px)
            == driver.view.pixels
        )
    )


def dropped(view, path):
    mime = QMimeData()
    mime.setUrls([QUrl.fromLocalFile(str(path))])
    spot, left = QPoint(50, 50), Qt.MouseButton.LeftButton
    enter = QDragEnterEvent(
        spot, Qt.DropAction.CopyAction, mime, left, Qt.KeyboardModifier.NoModifier
    )
    QApplication.sendEvent(view, enter)
    if enter.isAccepted():
        event = QDropEvent(QPointF(spot), Qt.DropAction.CopyAction, mime, left,
                           Qt.KeyboardModifier.NoModifier)  # fmt: skip
        QApplication.sendEvent(view, event)
    return enter.isAccepted()


def test_a_scene_is_dropped_on_the_picture(driver):
    """It is opened, looked at through its own camera, and named in the title."""
    assert dropped(driver.view, SCENES / "pavilion.gltf")
    driver.until_heard(SceneOpened, lambda m: m.path.endswith("pavilion.gltf"))
    assert "pavilion.gltf" in driver.window.windowTitle()
    driver.until(lambda: driver.view.camera.eye_m != (1.5, 1.5, 3.4))


def test_other_files_are_not_taken(driver, tmp_path):
    """A text file is refused before it is let go."""
    assert not dropped(driver.view, tmp_path / "notes.txt")

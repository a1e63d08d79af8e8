"""View, Enter VR: in a runtime's headset, and in a sentence why not where something is missing.

The tests in a headset need a runtime. Monado has a simulated headset; docs/headset.md says how it
is started.
"""

import importlib.util
import math
import os
import sys

import numpy as np
import pytest
from remote_headset import ENVIRONMENT, RemoteHeadset
from window_driver import SCENES

from vrut_lite.app.headset.controllers import SNAP_TURN_RAD
from vrut_lite.errors import UserError
from vrut_lite.host import Host
from vrut_lite.kernel.messages import ClockMoved
from vrut_lite.messages.camera import MoveCamera, frame_bounds
from vrut_lite.messages.scene import LoadScene, SceneOpened

WITH_PACKAGE = pytest.mark.skipif(
    importlib.util.find_spec("xr") is None, reason="pyopenxr is not installed (extra vr)"
)
IN_MONADO = pytest.mark.skipif(
    "XR_RUNTIME_JSON" not in os.environ,
    reason="XR_RUNTIME_JSON names no OpenXR runtime (package libopenxr1-monado, Debian 13)",
)


def vr(driver):
    return driver.window.actions_by_name["vr"]


def title(driver):
    return vr(driver).text().replace("&", "")


def refused(driver):
    """The sentence after Enter VR, when the window is what it was."""
    driver.problems.clear()
    vr(driver).trigger()
    driver.until(lambda: bool(driver.problems))
    assert title(driver) == "Enter VR"
    (sentence,) = driver.problems
    driver.problems.clear()
    return sentence


def test_without_opengl_a_sentence_says_so(shared_headless_window):
    assert refused(shared_headless_window) == (
        "VR needs OpenGL 4.3, which this machine does not have"
    )


@pytest.mark.gl
def test_without_the_package_a_sentence_names_the_extra(shared_drawn_window, monkeypatch):
    """And pictures are finished again, which they are not while a headset is worn."""
    driver = shared_drawn_window
    monkeypatch.setitem(sys.modules, "xr", None)
    assert refused(driver) == "VR needs pyopenxr: pip install 'vrut-lite[vr]'"
    pictures = []
    driver.session.picture_shown.connect(pictures.append)
    driver.window.desk.viewport.frame_scene()
    driver.until(lambda: bool(pictures) and pictures[-1].still)


@WITH_PACKAGE
@pytest.mark.gl
def test_without_a_runtime_a_sentence_says_what_to_start(
    shared_drawn_window, tmp_path, monkeypatch
):
    """And OpenGL is still opened by EGL, which pyopenxr would replace by GLX."""
    monkeypatch.setenv("XR_RUNTIME_JSON", str(tmp_path / "none.json"))
    sentence = refused(shared_drawn_window)
    assert sentence.startswith("no OpenXR runtime answers (")
    assert sentence.endswith(
        "): start one, such as Monado or WiVRn, or name its file in XR_RUNTIME_JSON"
    )
    from OpenGL import platform

    assert type(platform.PLATFORM).__name__ == "EGLPlatform"


def test_a_thumbstick_moves_the_clock_by_all_that_was_asked(shared_headless_window):
    """However few steps the kernel makes of it: ten minutes, sent by the headset's thread."""
    driver, headset = shared_headless_window, shared_headless_window.window.headset
    start = driver.session.last(ClockMoved).instant
    for _ in range(10):
        headset._told.emit("hour", 60.0)
    driver.until(lambda: (driver.session.last(ClockMoved).instant - start).total_seconds() >= 600.0)
    assert (driver.session.last(ClockMoved).instant - start).total_seconds() == 600.0


# --- in a headset --------------------------------------------------------------------------

EYE, TARGET = (-5.0, 9.0, 8.0), (0.0, 0.5, 0.0)
HEADING_RAD = math.atan2(TARGET[0] - EYE[0], EYE[2] - TARGET[2])


class WornHeadset:
    """A window whose scene a headset shows, and Monado's remote headset."""

    def __init__(self, driver):
        self.driver = driver
        driver.window.desk.viewport.go_to(MoveCamera(eye_m=EYE, target_m=TARGET))
        driver.settled()
        vr(driver).trigger()
        driver.until(lambda: title(driver) == "Leave VR")
        self.remote = RemoteHeadset()
        self.until_frames(2)

    @property
    def frames(self):
        """How many pictures of eyes were drawn."""
        return self.driver.asked(lambda stage: stage.frame_counters.done["eye"])

    def until_frames(self, count):
        """Return when so many more pictures of eyes were drawn."""
        end = self.frames + count
        self.driver.until(lambda: self.frames >= end)

    @property
    def camera(self):
        """Place (3,) of the window's camera, and the azimuth in which it looks level."""
        camera = self.driver.session.camera
        x, y, z = np.subtract(camera.target_m, camera.eye_m)
        assert y == 0.0
        return np.array(camera.eye_m), math.atan2(x, -z)


@pytest.fixture
def worn(drawn_window, monkeypatch):
    for name, value in ENVIRONMENT.items():
        monkeypatch.setenv(name, value)
    worn = WornHeadset(drawn_window)
    yield worn
    worn.remote.close()


@WITH_PACKAGE
@IN_MONADO
@pytest.mark.gl
def test_a_headset_shows_frames_until_it_is_left(worn):
    """Two eyes a frame, at the runtime's pace, while the window goes on. One stands on the ground
    below the window's camera, which comes down to the head and looks level where it looked."""
    worn.until_frames(20)
    place_m, azimuth = worn.camera
    ground_m = worn.driver.session.last(SceneOpened).ground.height_m
    assert place_m == pytest.approx((EYE[0], ground_m + 1.6, EYE[2]), abs=1e-5)
    assert azimuth == pytest.approx(HEADING_RAD, abs=1e-6)
    vr(worn.driver).trigger()
    worn.driver.until(lambda: title(worn.driver) == "Enter VR")
    assert worn.driver.problems == []
    worn.driver.until(lambda: worn.driver.session.shown.still)


@WITH_PACKAGE
@IN_MONADO
@pytest.mark.gl
def test_the_left_thumbstick_moves_the_hour(worn):
    """Forth to the right, until it rests."""
    session = worn.driver.session

    def instant():
        return session.last(ClockMoved).instant

    start = instant()
    worn.remote.send(left_x=1.0)
    worn.driver.until(lambda: (instant() - start).total_seconds() > 600.0)
    worn.remote.send(left_x=0.0)
    worn.until_frames(6)
    worn.driver.settled()
    rests = instant()
    worn.until_frames(6)
    assert instant() == rests


@WITH_PACKAGE
@IN_MONADO
@pytest.mark.gl
def test_the_right_thumbstick_turns_by_a_step(worn):
    """Once a push, about the head: 30 degrees to the right."""
    before_m, before_rad = worn.camera
    worn.remote.send(right_x=1.0)
    worn.driver.until(lambda: worn.camera[1] != before_rad)
    worn.until_frames(6)
    place_m, azimuth = worn.camera
    assert azimuth - before_rad == pytest.approx(SNAP_TURN_RAD, abs=1e-6)
    assert place_m == pytest.approx(before_m, abs=1e-6)


@WITH_PACKAGE
@IN_MONADO
@pytest.mark.gl
def test_a_released_trigger_teleports_to_where_the_hand_points(worn):
    """Straight down from the hand, half a metre ahead and 0.2 m to the right of the head."""
    before_m, azimuth = worn.camera
    down = (-math.sin(math.pi / 4), 0.0, 0.0, math.cos(math.pi / 4))
    worn.remote.send(hand_turn=down, trigger=1.0)
    worn.until_frames(6)
    assert worn.camera[0] == pytest.approx(before_m, abs=1e-6)
    worn.remote.send(trigger=0.0)
    worn.driver.until(lambda: not np.array_equal(worn.camera[0], before_m))
    ahead, right = math.sin(azimuth), math.cos(azimuth)
    moved_m = (0.5 * ahead + 0.2 * right, 0.0, -0.5 * right + 0.2 * ahead)
    assert worn.camera[0] - before_m == pytest.approx(moved_m, abs=0.05)


@WITH_PACKAGE
@IN_MONADO
@pytest.mark.gl
def test_in_another_scene_one_stands_below_its_camera(worn):
    """As on entering: on the ground straight below the eye from which the scene is seen."""
    driver, scene = worn.driver, str(SCENES / "spheres.glb")
    driver.session.send(LoadScene(path=scene))
    driver.until(lambda: driver.session.last(SceneOpened).path == scene)
    opened = driver.session.last(SceneOpened)
    seen_from = opened.camera or frame_bounds(opened.lower_m, opened.upper_m, 1.0)
    driver.until(lambda: driver.session.camera.target_m[1] == driver.session.camera.eye_m[1])
    worn.until_frames(4)
    x, y, z = worn.camera[0]
    assert y == pytest.approx(opened.ground.height_m + 1.6, abs=1e-4)
    assert (x < 0.0, z > 0.0) == (seen_from.eye_m[0] < 0.0, seen_from.eye_m[2] > 0.0)


@WITH_PACKAGE
@IN_MONADO
@pytest.mark.gl
def test_a_frame_that_cannot_be_drawn_ends_vr_with_a_sentence(worn, monkeypatch):
    """The runtime gets its frame and the end of the session; the window goes on, and VR again."""

    def without_memory(*_):
        raise UserError("there is no memory for a picture of 320 x 240")

    driver = worn.driver
    with monkeypatch.context() as patch:
        patch.setattr(Host, "draw_eyes", without_memory)
        driver.until(lambda: title(driver) == "Enter VR")
    assert driver.problems == ["there is no memory for a picture of 320 x 240"]
    driver.until(lambda: driver.session.shown.still)
    vr(driver).trigger()
    driver.until(lambda: title(driver) == "Leave VR")
    worn.until_frames(4)


@WITH_PACKAGE
@IN_MONADO
@pytest.mark.gl
def test_a_window_may_be_closed_with_the_headset_on(worn):
    """The headset's thread ends before OpenGL is closed: closing takes no longer than a frame."""
    worn.until_frames(2)

"""A page in a headset: a walk with an emulated one (npm's iwer), in Chromium from disk."""

import base64
import io
from pathlib import Path

import numpy as np
import pytest
from browser import Browser, chromium
from PIL import Image

EMULATOR = Path(__file__).parents[2] / ".page/node_modules/iwer/build/iwer.min.js"
WALK = Path(__file__).with_name("headset_walk.js")
# A headset of two eyes, 63 mm apart; its vertical field of view is 90 degrees.
INSTALL = """
    window.emulated = new IWER.XRDevice(IWER.metaQuest3, {
        stereoEnabled: true, ipd: 0.063, fovy: Math.PI / 2 });
    window.emulated.installRuntime({ forceInstall: true });
"""
# The middle lantern of room.glb: the centre of its sphere.
LANTERN_M = np.array([0.0, 2.1, -0.4])


@pytest.fixture(scope="module")
def walked(written, tmp_path_factory):
    """Pictures and state after each step of the walk."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    if not EMULATOR.is_file():
        pytest.skip("needs npm's iwer: sh tools/bootstrap.sh page")
    folder = tmp_path_factory.mktemp("headset")
    page = folder / "room.html"
    scripts = f"<script>{EMULATOR.read_text()}</script><script>{INSTALL}</script>"
    page.write_text(written[0].read_text().replace("<footer>", f"{scripts}<footer>", 1))
    browser = Browser(folder / "profile", (480, 240))
    try:
        browser.open(page.as_uri())
        found = browser.value(f"{WALK.read_text()}; walk()", 400.0)
        assert browser.errors == []
        return found
    finally:
        browser.close()


def pictures(seen):
    """Pictures of the left and the right eye (h, w), in 0..255."""
    content = base64.b64decode(seen["picture"].partition(",")[2])
    both = np.asarray(Image.open(io.BytesIO(content)).convert("L"), float)
    return np.split(both, 2, axis=1)


def lantern_px(picture):
    """Column of the middle lantern's centre: that of the bright pixels before the others."""
    height, width = picture.shape
    aside = round(0.075 * width)
    part = picture[: height // 2, width // 2 - aside : width // 2 + aside]
    return np.nonzero(part > 0.7 * part.max())[1].mean()


@pytest.mark.long
def test_a_person_stands_on_the_floor_where_the_view_is(walked):
    """Eyes 1.6 m above the floor, over the view's place, looking its way."""
    eyes = np.array(walked["entered"]["eyes_m"])
    view = np.array(walked["view"])
    assert eyes.mean(axis=0) == pytest.approx([view[12], 1.6, view[14]], abs=0.002)
    ahead, looks = np.array(walked["entered"]["ahead"]), -view[8:11]
    assert ahead[[0, 2]] == pytest.approx(looks[[0, 2]] / np.hypot(*looks[[0, 2]]), abs=1e-3)


@pytest.mark.long
def test_two_eyes_see_the_scene_from_their_places(walked):
    """The lantern shifts by focal length times distance of the eyes over its depth."""
    left, right = pictures(walked["entered"])
    depth_m = np.mean(walked["entered"]["eyes_m"], axis=0)[2] - LANTERN_M[2]
    focal_px = left.shape[0] / 2.0
    shift = lantern_px(left) - lantern_px(right)
    assert shift == pytest.approx(focal_px * 0.063 / depth_m, abs=0.5)
    assert shift > 1.0
    # One light and one exposure for both.
    assert left.mean() == pytest.approx(right.mean(), rel=0.05)
    assert left.max() > 100.0


@pytest.mark.long
def test_a_hand_takes_a_person_to_level_floors_alone(walked):
    """Along its ray, 0.6 rad down from 1.3 m; not onto the wall that it points to next."""
    assert walked["aimed"]["ring"]
    before, after = (np.mean(walked[k]["eyes_m"], axis=0) for k in ("entered", "gone"))
    # The hand is 0.3 m behind the head and 0.2 m to its right.
    hand_z = before[2] - 0.3
    goal = [before[0] + 0.2, 1.6, hand_z - 1.3 / np.tan(0.6)]
    assert after == pytest.approx(goal, abs=0.02)
    assert walked["at_wall"]["ring"]
    assert np.mean(walked["stayed"]["eyes_m"], axis=0) == pytest.approx(after, abs=1e-3)


@pytest.mark.long
def test_sticks_turn_and_set_the_hour(walked):
    """A push turns once by 30 degrees about the head; the other stick moves the clock."""
    before, after = walked["stayed"], walked["turned"]
    cosine = np.dot(before["ahead"], after["ahead"])
    assert np.degrees(np.arccos(cosine)) == pytest.approx(30.0, abs=0.01)
    middles = [np.mean(seen["eyes_m"], axis=0) for seen in (before, after)]
    assert middles[0] == pytest.approx(middles[1], abs=1e-3)
    assert walked["later"]["minute"] > after["minute"] + 10.0
    assert walked["later"]["clock"] != after["clock"]
    hour = int(walked["later"]["minute"])
    assert walked["later"]["clock"].startswith(f"{hour // 60:02d}:{hour % 60:02d}\n")


@pytest.mark.long
def test_one_hand_does_it_all(walked):
    """Its grip turns, for its stick has the hour."""
    cosine = np.dot(walked["later"]["ahead"], walked["one_hand"]["ahead"])
    assert np.degrees(np.arccos(cosine)) == pytest.approx(30.0, abs=0.01)


@pytest.mark.long
def test_who_leaves_finds_the_view_of_before_at_the_hour_of_now(walked):
    assert walked["left"]["view"] == walked["view"]
    assert walked["left"]["minute"] == walked["later"]["minute"]
    assert walked["left"]["button"] == "Enter VR"

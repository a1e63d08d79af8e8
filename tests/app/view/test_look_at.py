"""The camera turns to the sun and to the moon, or a sentence says why not."""

from datetime import UTC, datetime

import numpy as np
import pytest
from PySide6.QtCore import Qt

from vrut_lite.kernel.messages import SetClock
from vrut_lite.messages.night import NightLightChanged
from vrut_lite.messages.sun import SunMoved

NIGHT = datetime(2026, 6, 21, 23, 0, tzinfo=UTC)
# Full moon of June 2026, high in the south at midnight.
FULL_MOON = datetime(2026, 6, 29, 23, 0, tzinfo=UTC)


@pytest.fixture
def driver(shared_headless_window):
    return shared_headless_window.activated()


def seen_by(camera):
    way = np.subtract(camera.target_m, camera.eye_m)
    return way / np.linalg.norm(way)


def test_the_camera_turns_to_the_sun_where_it_stands(driver):
    """By its key; the eye stays."""
    viewport = driver.window.desk.viewport
    before, sun = viewport.camera, driver.session.last(SunMoved)
    viewport.setFocus()
    driver.qtbot.keyClick(viewport, Qt.Key.Key_O)
    assert seen_by(viewport.camera) == pytest.approx(sun.direction, abs=1e-6)
    assert viewport.camera.eye_m == before.eye_m


def test_a_sun_below_the_horizon_is_told_in_a_sentence(driver):
    """With the hour at which it rises, if that is still to come; the camera stays."""
    driver.session.send(SetClock(instant=NIGHT))
    driver.until_heard(SunMoved, lambda m: m.elevation_rad < 0.0)
    before = driver.window.desk.viewport.camera
    driver.until(lambda: driver.window.desk.scout.day.start.day == 21)
    driver.window.look_at_sun()
    assert driver.window.news.text().startswith("The sun is ")
    assert "\N{DEGREE SIGN} below the horizon" in driver.window.news.text()
    assert driver.window.desk.viewport.camera == before


def test_the_camera_turns_to_the_moon(driver):
    """It is above the horizon at a full moon's midnight."""
    driver.session.send(SetClock(instant=FULL_MOON))
    night = driver.until_heard(
        NightLightChanged, lambda m: m.moon is not None and m.instant == FULL_MOON
    )
    driver.settled()
    driver.window.look_at_moon()
    camera = driver.window.desk.viewport.camera
    assert seen_by(camera) == pytest.approx(night.moon.place.direction, abs=1e-6)


def test_a_moon_below_the_horizon_is_told_in_a_sentence(driver):
    """Instead of a look at the ground."""
    driver.session.send(SetClock(instant=FULL_MOON.replace(hour=10)))
    driver.until_heard(NightLightChanged, lambda m: m.instant == FULL_MOON.replace(hour=10))
    driver.settled()
    before = driver.window.desk.viewport.camera
    driver.window.look_at_moon()
    assert driver.window.news.text().startswith("The moon is below the horizon")
    assert driver.window.desk.viewport.camera == before

"""A year of weather in the window: opened, shown above the hours, gone to, saved."""

import logging
from datetime import UTC, datetime

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt

from vrut_lite.app.panels.year_strip import cloud_pixels
from vrut_lite.kernel.messages import ChooseSlot, ClockMoved, RestartModule, SetClock, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.weather import SetWeather

HOURS = np.arange(8760)
SUNNY = np.clip(np.sin((HOURS % 24 - 6) / 12 * np.pi), 0, 1)
YEAR = SetWeather(
    path="year.epw",
    name="Cairo",
    latitude_deg=30.1,
    longitude_deg=31.4,
    altitude_m=70.0,
    utc_offset_h=2.0,
    direct_normal_w_m2=tuple(800.0 * SUNNY),
    diffuse_horizontal_w_m2=tuple(100.0 * SUNNY),
    dew_point_c=(10.0,) * 8760,
    cloud_cover=tuple(np.where(HOURS < 2400, 1.0, 0.0)),
    lacks=("1 hour lacks the dew point: the same hour of the nearest day stands in",),
)


@pytest.fixture
def driver(shared_headless_window, monkeypatch):
    monkeypatch.setattr("vrut_lite.app.window.files.read_weather", lambda path: YEAR)
    return shared_headless_window


def test_a_year_opens_with_its_place_its_sky_and_its_clouds(driver, qtbot):
    """The menu's entry: place, sky and sun are the file's, what it lacks is told."""
    window = driver.window
    strip = window.time.year
    assert strip.isHidden()
    window.files.open_weather("year.epw")
    driver.until_heard(SetPlace, lambda place: place.latitude_deg == 30.1)
    driver.until(lambda: driver.session.catalogue.holders["sky"] == "weather_sky")
    assert driver.session.catalogue.holders["sun"] == "weather_sky"
    driver.until(lambda: not strip.isHidden())
    assert window.files.present_project.weather == "year.epw"
    # The 100th day, a quarter down: the hour from 6 to 7 of standard time, in its middle.
    x = int(16 + (99.5 / 365) * (strip.width() - 32))
    qtbot.mouseClick(
        strip, Qt.MouseButton.LeftButton, pos=QPoint(x, int(6.5 / 24 * strip.height()))
    )
    driver.until_heard(ClockMoved, lambda m: (m.instant.month, m.instant.day) == (4, 10))
    assert driver.session.last(ClockMoved).instant.strftime("%H:%M") == "04:30"


def test_clouds_are_white_and_nights_dark():
    """A column a day, the first hour on top; a clear day is blue."""
    pixels = cloud_pixels(YEAR).astype(int)
    assert pixels.shape == (24, 365, 3)
    cloudy, clear, night = pixels[12, 50], pixels[12, 200], pixels[0, 200]
    assert np.ptp(cloudy) < 10
    assert clear[2] > clear[0] + 100
    assert night.max() < 40


def test_light_outside_perez_model_is_told_in_the_status_line(driver):
    """Another sky stands in for the hour: who has no terminal must see that too."""
    noon = datetime(2026, 3, 20, 12, 30, tzinfo=UTC)
    # It is said once, and the window is shared with other tests.
    driver.session.send(RestartModule(module="weather_sky"))
    driver.session.send(SetPlace(latitude_deg=9.0, longitude_deg=0.0), SetClock(instant=noon))
    driver.session.send(ChooseSlot(slot="sky", module="weather_sky"))
    for name, value in (("direct_normal_w_m2", 150.0), ("diffuse_horizontal_w_m2", 50.0)):
        driver.session.send(SetSetting(module="weather_sky", name=name, value=value))
    driver.until(lambda: "lie outside Perez's sky" in driver.window.news.text())
    logging.getLogger("some_library").warning("for developers")
    driver.session.send(SetPlace(latitude_deg=10.0, longitude_deg=0.0))
    driver.until_heard(SetPlace, lambda place: place.latitude_deg == 10.0)
    assert "for developers" not in driver.window.news.text()

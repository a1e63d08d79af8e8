"""Where on Earth: typed, searched, clicked."""

import math

import pytest
from PySide6.QtCore import Qt

from vrut_lite.messages.place import SetPlace


@pytest.fixture
def driver(shared_headless_window):
    window = shared_headless_window
    window.place = window.panel("place")
    window.place.search.clear()
    return window


def test_a_city_is_found_as_one_types(driver, qtbot):
    """Suggestions come with each letter; Enter takes the first: Quito, 2850 m up."""
    qtbot.keyClicks(driver.place.search, "quit")
    assert driver.place.found.item(0).text() == "Quito, EC"
    qtbot.keyClick(driver.place.search, Qt.Key.Key_Return)
    there = driver.until_heard(SetPlace)
    assert (round(there.latitude_deg), round(there.longitude_deg)) == (0, -79)
    assert there.altitude_m == 2850
    driver.until(lambda: "Guayaquil" in driver.place.zone.text())
    driver.until(lambda: driver.window.desk.scout.day.zone.key == "America/Guayaquil")


def test_a_suggestion_is_taken_by_a_click(driver, qtbot):
    """The second of the list, not the first."""
    qtbot.keyClicks(driver.place.search, "san")
    item = driver.place.found.item(1)
    spot = driver.place.found.visualItemRect(item).center()
    qtbot.mouseClick(driver.place.found.viewport(), Qt.MouseButton.LeftButton, pos=spot)
    driver.until_heard(SetPlace)
    assert driver.place.search.text() == item.text()
    driver.until(lambda: driver.place.name.text() == item.text())


def test_coordinates_may_be_typed(driver, qtbot):
    """Latitude, longitude and altitude as the command line takes them."""
    qtbot.keyClicks(driver.place.search, "-33.87, 151.21, 40")
    qtbot.keyClick(driver.place.search, Qt.Key.Key_Return)
    there = driver.until_heard(SetPlace)
    assert (there.latitude_deg, there.longitude_deg, there.altitude_m) == (-33.87, 151.21, 40.0)
    driver.until(lambda: driver.place.name.text() == "Sydney, AU")


@pytest.mark.parametrize(
    ("text", "said"),
    [("Xyzzyville", "not among the"), ("95, 10", "latitude"), ("1,2,3,4", "no place")],
)
def test_what_is_no_place_is_told_in_one_line(driver, qtbot, text, said):
    """And nothing moves."""
    qtbot.keyClicks(driver.place.search, text)
    qtbot.keyClick(driver.place.search, Qt.Key.Key_Return)
    assert said in driver.window.news.text()
    driver.settled()
    assert not any(isinstance(message, SetPlace) for message in driver.heard)


def test_the_map_is_clicked(driver, qtbot):
    """A click where Rio lies stands there, to half a degree or the map's pixel."""
    world = driver.place.map
    spot = world.position_of(-22.9, -43.2).toPoint()
    qtbot.mouseClick(world, Qt.MouseButton.LeftButton, pos=spot)
    there = driver.until_heard(SetPlace)
    pixel_deg = 360.0 / world.width()
    assert abs(there.latitude_deg + 22.9) <= pixel_deg + 0.1
    assert abs(there.longitude_deg + 43.2) <= pixel_deg + 0.1


def test_north_offset_turns_the_sun_in_the_scene(driver):
    """90 degrees: the world's -Z points east, so the noon sun in the south is at world +X."""
    driver.place.north_deg.spin.setValue(90.0)
    there = driver.until_heard(SetPlace)
    assert there.north_offset_rad == pytest.approx(math.pi / 2)
    assert there.latitude_deg == pytest.approx(50.0755)


def test_altitude_is_typed(driver):
    """Snezka's 1603 m goes out with the rest of the place unchanged."""
    driver.place.altitude_m.spin.setValue(1603)
    there = driver.until_heard(SetPlace)
    assert there.altitude_m == 1603.0
    assert there.longitude_deg == pytest.approx(14.4378)

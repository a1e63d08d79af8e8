"""Where on Earth: typed, searched, clicked."""

import math

import pytest
from PySide6.QtCore import Qt
from window_driver import NOON

from vrut_lite.kernel.messages import ClockMoved, SetClock
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


def type_a_place(driver):
    driver.type_in(driver.place.search, "35.68, 139.69")


def choose_a_city(driver):
    driver.qtbot.keyClicks(driver.place.search, "toky")
    first = driver.place.found.visualItemRect(driver.place.found.item(0)).center()
    driver.qtbot.mouseClick(driver.place.found.viewport(), Qt.MouseButton.LeftButton, pos=first)


def click_on_the_map(driver):
    spot = driver.place.map.position_of(36.5, 138.5).toPoint()
    driver.qtbot.mouseClick(driver.place.map, Qt.MouseButton.LeftButton, pos=spot)


@pytest.mark.parametrize("go", [type_a_place, choose_a_city, click_on_the_map])
def test_the_clock_shows_the_same_hour_at_a_new_place(driver, go):
    """13:00 in Prague becomes 13:00 in Tokyo, seven hours earlier; one undo brings both back."""
    assert f"{driver.local():%H:%M}" == "13:00"
    go(driver)
    driver.until(lambda: driver.window.desk.scout.day.zone.key == "Asia/Tokyo")
    # The clock's message may come after the place's.
    driver.until(lambda: f"{driver.local():%d %H:%M}" == "21 13:00")
    assert driver.window.time.clock.text() == "13:00:00"
    driver.window.undo()
    driver.until(lambda: driver.session.last(ClockMoved).instant == NOON)
    driver.until(lambda: driver.window.desk.scout.day.zone.key == "Europe/Prague")
    assert driver.window.news.text() == "Undone: place"


def test_a_place_of_the_same_zone_leaves_the_clock_alone(driver):
    """So does another altitude: nothing is sent that changes nothing."""
    sent = []
    driver.session.sent.connect(sent.append)
    driver.type_in(driver.place.search, "49.2, 16.6")
    driver.place.altitude_m.spin.setValue(300)
    driver.settled()
    driver.session.sent.disconnect(sent.append)
    assert [type(message) for message in sent] == [SetPlace, SetPlace]
    assert not any(isinstance(message, SetClock) for message in sent)


def test_keys_go_to_the_picture_once_a_place_is_found(driver, qtbot):
    """P typed after Enter shows the sun's path, and is no letter of the place; an unknown place
    keeps the field, to be mended."""
    driver.activated()
    driver.window.show_dock("place")
    driver.type_in(driver.place.search, "Xyzzyville")
    assert driver.place.search.hasFocus()
    driver.type_in(driver.place.search, "Quito")
    view = driver.window.desk.viewport
    assert driver.window.focusWidget() is view
    action = driver.window.actions_by_name["sun path"]
    before = action.isChecked()
    qtbot.keyClick(view, Qt.Key.Key_P)
    assert action.isChecked() is not before
    assert "p" not in driver.place.search.text()[5:]
    qtbot.keyClick(view, Qt.Key.Key_P)

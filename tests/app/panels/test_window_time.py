"""The time bar and what surrounds it, by mouse and keys."""

from datetime import UTC, datetime, timedelta

import pytest
from PySide6.QtCore import QDate, QPoint, Qt, QTime

from vrut_lite.app.panels.day_bar import light_colour
from vrut_lite.kernel.messages import ClockMoved, SetClock, SetSetting
from vrut_lite.messages.place import SetPlace


@pytest.fixture
def driver(shared_headless_window):
    window = shared_headless_window
    window.time = window.window.time
    window.bar = window.window.time.bar
    return window


def place_of(driver, hours):
    start = driver.window.desk.scout.day.start
    return driver.bar.place_of(start + timedelta(hours=hours)).toPoint()


def test_dragging_the_bar_moves_the_sun(driver, qtbot):
    """From noon to the evening: the clock follows the pointer to a pixel's worth of minutes."""
    left = Qt.MouseButton.LeftButton
    qtbot.mousePress(driver.bar, left, pos=place_of(driver, 13))
    for hours in (14, 16, 18, 20):
        qtbot.mouseMove(driver.bar, place_of(driver, hours))
    qtbot.mouseRelease(driver.bar, left, pos=place_of(driver, 20))
    driver.until_heard(ClockMoved, lambda m: abs(local_hour(driver, m.instant) - 20.0) < 0.1)
    driver.until(lambda: driver.panel("sun").elevation.value() < 12.0)
    assert driver.time.clock.time.hour() in (19, 20)


def test_a_step_of_a_drag_merges_with_the_next(driver, qtbot):
    """A hundred moves in a burst become few transactions: no backlog for a slider to drag."""
    for i in range(100):
        driver.bar.instant_chosen.emit(driver.window.desk.scout.day.instant_at(i / 100))
    last = driver.window.desk.scout.day.instant_at(0.99)
    driver.until(lambda: driver.session.last(ClockMoved).instant == last)
    assert sum(isinstance(m, SetClock) for m in driver.heard) < 50


def test_marks_are_gone_to_by_a_click(driver, qtbot):
    """The mark's own instant to the microsecond, not the pixel's."""
    for mark in ("sunrise", "noon", "sunset", "civil dusk"):
        spot = driver.bar.mark_place(mark).toPoint()
        qtbot.mouseClick(driver.bar, Qt.MouseButton.LeftButton, pos=spot)
        wanted = driver.window.desk.scout.day.marks[mark]
        driver.until(lambda wanted=wanted: driver.session.last(ClockMoved).instant == wanted)


def test_the_moons_rise_is_gone_to_by_a_click(driver, qtbot):
    """Told by whichever module knows the moon: marked, underlined while it is up, told beside the
    sun."""
    driver.until(lambda: driver.window.desk.scout.moon is not None)
    moon = driver.window.desk.scout.moon
    wanted = moon.marks["moonrise"]
    spot = driver.bar.mark_place("moonrise").toPoint()
    qtbot.mouseClick(driver.bar, Qt.MouseButton.LeftButton, pos=spot)
    driver.until(lambda: driver.session.last(ClockMoved).instant == wanted)
    panel = driver.panel("sun")
    driver.until(lambda: "azimuth" in panel.moon.text())
    assert f"from {driver.local():%H:%M}" in panel.moon_hours.text()
    since, until = moon.up[-1]
    assert since < driver.window.desk.scout.day.share_of(wanted) + 1e-9 < until


def test_arrows_step_and_home_goes_to_sunrise(driver, qtbot):
    """All of the bar is reached from the keyboard: 5 minutes, an hour with Ctrl, Home, End."""
    driver.bar.setFocus()
    noon = driver.session.last(ClockMoved).instant
    qtbot.keyClick(driver.bar, Qt.Key.Key_Right)
    driver.until(lambda: driver.session.last(ClockMoved).instant == noon + timedelta(minutes=5))
    qtbot.keyClick(driver.bar, Qt.Key.Key_Left, Qt.KeyboardModifier.ControlModifier)
    driver.until(lambda: driver.session.last(ClockMoved).instant == noon - timedelta(minutes=55))
    qtbot.keyClick(driver.bar, Qt.Key.Key_End)
    sunset = driver.window.desk.scout.day.marks["sunset"]
    driver.until(lambda: driver.session.last(ClockMoved).instant == sunset)


def test_a_typed_time_is_the_places_own(driver, qtbot):
    """07:30 in Prague in June is 05:30 UTC, whatever the computer's zone."""
    driver.time.clock.time_typed.emit(QTime(7, 30))
    driver.until(
        lambda: driver.session.last(ClockMoved).instant == datetime(2026, 6, 21, 5, 30, tzinfo=UTC)
    )


def test_a_time_that_clocks_skip_is_refused_with_both_readings(driver):
    """On 29 March 2026 Prague has no 02:30: a line says so, and the clock stays."""
    driver.time.clock.time_typed.emit(QTime(2, 30))
    driver.until(lambda: driver.local().hour == 2)
    before = driver.session.last(ClockMoved).instant
    driver.time.date.setDate(QDate(2026, 3, 29))
    assert "never" in driver.window.news.text()
    assert "+01:00" in driver.window.news.text()
    driver.settled()
    assert driver.session.last(ClockMoved).instant == before
    assert driver.time.date.date() == QDate(2026, 6, 21)


def test_a_new_date_makes_a_new_bar(driver):
    """December's sunset is before 17:00 in Prague, June's after 21:00; the hour stays."""
    driver.time.date.setDate(QDate(2026, 12, 21))
    driver.until(lambda: driver.window.desk.scout.day.start.month == 12)
    day = driver.window.desk.scout.day
    assert day.marks["sunset"].astimezone(day.zone).hour == 16
    assert driver.local().hour == 13
    driver.time.step_days(1)
    driver.until(lambda: driver.local().day == 22)


def test_play_lets_time_go_by_at_the_chosen_speed_and_pause_stops_it(driver, qtbot):
    """At an hour a second the clock moves on; paused it stands."""
    driver.time.speed.setCurrentText("1 s = 1 h")
    driver.time.speed.activated.emit(driver.time.speed.currentIndex())
    start = driver.session.last(ClockMoved).instant
    driver.window.actions_by_name["play"].trigger()
    driver.until(lambda: driver.session.last(ClockMoved).instant > start + timedelta(minutes=20))
    assert driver.time.play.isChecked()
    driver.window.actions_by_name["play"].trigger()
    driver.settled()
    stood = driver.session.last(ClockMoved).instant
    driver.settled()
    assert driver.session.last(ClockMoved).instant == stood
    assert not driver.time.play.isChecked()


def test_a_setting_that_a_hand_drags_searches_the_suns_day_when_it_rests(driver, monkeypatch):
    """Once for all its moves: the search takes longer than a picture."""
    scout, searched = driver.window.desk.scout, []
    scout._rest.setInterval(60_000)
    monkeypatch.setattr(scout, "_search", lambda second, wanted: searched.append(wanted))
    for turbidity in (3.0, 3.5, 4.0):
        driver.session.send(
            SetSetting(module="dynamic_skylight", name="turbidity", value=turbidity)
        )
        driver.settled()
    assert searched == []
    scout._rest.start(0)
    driver.until(lambda: len(searched) > 0)
    assert [wanted.settings["dynamic_skylight", "turbidity"] for wanted in searched] == [4.0]


def test_now_is_now(driver, qtbot):
    """The clock stands at the computer's own instant."""
    qtbot.mouseClick(driver.time.now, Qt.MouseButton.LeftButton)
    before = datetime.now(UTC)
    driver.until(
        lambda: abs(driver.session.last(ClockMoved).instant - before) < timedelta(seconds=5)
    )


def test_the_zone_is_derived_and_names_daylight_saving(driver):
    """June in Prague is UTC+2 with daylight saving; in Sydney it is winter."""
    assert driver.time.zone.text() == "Europe/Prague (UTC+2, daylight saving)"
    driver.session.send(SetPlace(latitude_deg=-33.87, longitude_deg=151.21))
    driver.until(lambda: driver.time.zone.text() == "Australia/Sydney (UTC+10)")


def test_the_bar_is_darker_the_lower_the_sun():
    """Night, twilight, day: lightness must rise with the sun up to 8 degrees."""
    lightness = [light_colour(h).lightnessF() for h in (-20, -9, -4, 0, 4, 8)]
    assert lightness == sorted(lightness)


def test_the_bar_is_painted_in_the_days_light(driver, qtbot):
    """The widget's own pixels: dark at midnight, blue at noon, warm at sunset."""
    image = driver.bar.grab().toImage()

    def colour(hours):
        spot: QPoint = place_of(driver, hours)
        # Above the hand's knob.
        return image.pixelColor(spot.x(), spot.y() - 9)

    assert colour(0.2).lightnessF() < 0.15
    assert colour(11).blueF() > colour(11).redF() + 0.1
    assert colour(21.2).redF() > colour(21.2).blueF() + 0.1


def local_hour(driver, instant):
    local = instant.astimezone(driver.window.desk.scout.day.zone)
    return local.hour + local.minute / 60

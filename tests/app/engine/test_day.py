"""The sun's day as the window samples it, against the module's own almanac."""

import dataclasses
from datetime import UTC, date, datetime, timedelta
from zoneinfo import ZoneInfo

import numpy as np
import pytest
from dynamic_skylight.sun.events import sun_events
from hypothesis import given, settings
from hypothesis import strategies as st

from vrut_lite.app.engine.day import Day, day_of
from vrut_lite.app.engine.moon_day import moon_of
from vrut_lite.app.engine.preview_kernel import PreviewKernel
from vrut_lite.array import Array
from vrut_lite.messages.moon_path import MoonPathChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.sky.day_events import DAY_EVENTS

PLACES = [
    ("Prague", 50.0755, 14.4378, "Europe/Prague", date(2026, 6, 21)),
    ("Sydney", -33.87, 151.21, "Australia/Sydney", date(2026, 12, 1)),
    ("Quito", -0.18, -78.47, "America/Guayaquil", date(2026, 3, 20)),
    ("Anchorage", 61.22, -149.9, "America/Anchorage", date(2026, 11, 1)),
    # The limb is refracted above the horizon for eight minutes, and for none.
    ("polar noon", 67.40, 25.0, "UTC", date(2026, 12, 21)),
    ("polar night", 67.42, 25.0, "UTC", date(2026, 12, 21)),
    ("midnight sun", 65.72, -2.0, "UTC", date(2026, 6, 21)),
]


@pytest.fixture(scope="module")
def second():
    return PreviewKernel()


def day_at(second, latitude_deg, longitude_deg, zone, day, altitude_m=0.0):
    place = SetPlace(latitude_deg=latitude_deg, longitude_deg=longitude_deg, altitude_m=altitude_m)
    second.set_up(place, "dynamic_skylight", {})
    return day_of(second, day, ZoneInfo(zone))


@pytest.mark.parametrize("altitude_m", [0.0, 3000.0])
@pytest.mark.parametrize("place", PLACES, ids=[place[0] for place in PLACES])
def test_marks_are_those_of_the_almanac(second, place, altitude_m):
    """The window's bar and scripts have one sunrise, also where the sun only grazes the horizon."""
    _, latitude_deg, longitude_deg, zone, day = place
    found = day_at(second, latitude_deg, longitude_deg, zone, day, altitude_m)
    zone = ZoneInfo(zone)
    events = sun_events(day, latitude_deg, longitude_deg, time_zone=zone, altitude_m=altitude_m)
    for name in DAY_EVENTS:
        expected = getattr(events, name.replace(" ", "_"))
        assert (name in found.marks) == (expected is not None), name
        if expected is not None:
            assert abs((found.marks[name] - expected).total_seconds()) < 0.1, name


@settings(max_examples=25, deadline=None)
@given(
    latitude_deg=st.one_of(st.floats(-90.0, 90.0), st.floats(65.5, 68.5), st.floats(-68.5, -65.5)),
    longitude_deg=st.floats(-180.0, 180.0),
    number=st.integers(0, 364),
    altitude_m=st.sampled_from([0.0, 4000.0]),
)
def test_any_day_has_one_sunrise_in_bar_and_scripts(
    second, latitude_deg, longitude_deg, number, altitude_m
):
    """Also about the polar circles, where the sun grazes the horizon, and at the poles."""
    day = date(2026, 1, 1) + timedelta(number)
    found = day_at(second, latitude_deg, longitude_deg, "UTC", day, altitude_m).marks
    events = sun_events(
        day, latitude_deg, longitude_deg, time_zone=ZoneInfo("UTC"), altitude_m=altitude_m
    )
    for name in ("sunrise", "sunset"):
        expected = getattr(events, name)
        assert (name in found) == (expected is not None)
        if expected is not None:
            assert abs((found[name] - expected).total_seconds()) < 0.1


def test_a_day_on_which_clocks_change_is_as_long_as_it_is(second):
    """In Prague 29 March 2026 has 23 hours, and 25 October 25: the bar spans just them."""
    lengths = [
        day_at(second, 50.0, 14.4, "Europe/Prague", day).length_s / 3600
        for day in (date(2026, 3, 29), date(2026, 6, 1), date(2026, 10, 25))
    ]
    assert lengths == [23.0, 24.0, 25.0]


def test_midnight_sun_has_neither_sunrise_nor_sunset(second):
    """In Tromso the sun stays up in June: the day has a noon and no other event."""
    assert list(day_at(second, 69.65, 18.96, "Europe/Oslo", date(2026, 6, 21)).marks) == ["noon"]


@pytest.mark.parametrize("hour", [9, 16])
def test_an_elevation_is_found_on_the_same_side_of_noon(second, hour):
    """Typing 30 degrees in the afternoon must not jump to the morning; good to 0.01 degrees."""
    day = day_at(second, 50.0755, 14.4378, "Europe/Prague", date(2026, 6, 21))
    near = datetime(2026, 6, 21, hour - 2, tzinfo=UTC)
    when = day.when_elevation(30.0, near)
    assert abs(np.degrees(second.sun_at(when).elevation_rad) - 30.0) < 0.01
    assert (when < day.marks["noon"]) == (near < day.marks["noon"])
    assert day.when_elevation(80.0, near) is None


@pytest.mark.parametrize("azimuth_deg", [5.0, 90.0, 180.0, 270.0, 355.0])
def test_an_azimuth_is_found_all_around(second, azimuth_deg):
    """North, where azimuths jump from 360 to 0, is no obstacle; good to 0.05 degrees."""
    day = day_at(second, 50.0755, 14.4378, "Europe/Prague", date(2026, 6, 21))
    when = day.when_azimuth(azimuth_deg, day.start + timedelta(hours=12))
    off = np.degrees(second.sun_at(when).azimuth_rad) - azimuth_deg
    assert abs((off + 180.0) % 360.0 - 180.0) < 0.05


def test_shares_of_the_day_lead_there_and_back(second):
    """The bar's position and the clock agree within half a second and stay within the day."""
    day = day_at(second, 50.0755, 14.4378, "Europe/Prague", date(2026, 10, 25))
    for share in np.linspace(0.0, 0.999, 7):
        assert abs(day.share_of(day.instant_at(share)) - share) * day.length_s <= 0.5
    assert day.start <= day.instant_at(-1.0) < day.instant_at(2.0) < day.end


def test_the_moon_of_a_day_is_cut_out_of_its_path():
    """A moon that is up from 20:00 until 6:00 next morning is up twice in a civil day; a path that
    does not reach over the day is of another one."""
    midnight = datetime(2026, 6, 21, tzinfo=UTC)
    hours = np.arange(-14, 37)
    up = np.where((hours % 24 >= 20) | (hours % 24 < 6), 1.0, -1.0)
    path = MoonPathChanged(
        start=midnight - timedelta(hours=14),
        step_s=3600.0,
        direction=Array(np.stack([0.0 * up, up, 0.0 * up], axis=-1).astype(np.float32)),
        rises_s=(10 * 3600.0, 34 * 3600.0),
        sets_s=(20 * 3600.0, 44 * 3600.0),
        source="test",
    )
    path.check()
    seconds, none = np.linspace(0.0, 86400.0, 25), np.zeros(25)
    next_one = midnight + timedelta(days=1)
    day = Day(midnight, next_one, UTC, seconds, none, none, np.zeros((25, 3)), {})
    moon = moon_of(day, path)
    assert moon.marks == {
        "moonrise": midnight + timedelta(hours=20),
        "moonset": midnight + timedelta(hours=6),
    }
    assert moon.up == [(0.0, 0.25), (20 / 24, 1.0)]
    assert np.array_equal(moon.direction[:, 1] > 0.0, up[14:39] > 0.0)
    later = dataclasses.replace(day, start=next_one, end=next_one + timedelta(days=1))
    assert moon_of(later, path) is None

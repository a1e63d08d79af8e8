"""Sunrise, noon, sunset and the twilights of a day, against an almanac's own search."""

from dataclasses import astuple, fields
from datetime import UTC, date, datetime, timedelta, timezone
from zoneinfo import ZoneInfo

import astronomy
import numpy as np
import pytest
from dynamic_skylight import SunEvents, sun_events, sun_position
from hypothesis import example, given
from hypothesis import strategies as st

from vrut_lite.atmosphere.refraction import refraction_of_true_rad
from vrut_lite.sky.visible_disc import MEAN_ANGULAR_RADIUS_RAD

J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
NAMES = [field.name for field in fields(SunEvents)]
PRAGUE = (50.0755, 14.4378)
TWILIGHTS = {"civil": -6.0, "nautical": -12.0, "astronomical": -18.0}


def to_almanac(when):
    return astronomy.Time((when - J2000).total_seconds() / 86_400)


def from_almanac(time):
    return None if time is None else J2000 + timedelta(days=time.ut)


def apart_s(ours, almanacs):
    return abs((ours - almanacs).total_seconds())


@pytest.mark.parametrize("latitude", [-50.0, -23.0, 0.0, 35.0, 50.0, 60.0])
@pytest.mark.parametrize("day", [date(2026, 3, 20), date(2026, 6, 21), date(1999, 11, 3)])
def test_against_the_almanacs_own_search(latitude, day):
    """astronomy-engine's SearchAltitude, SearchHourAngle and SearchRiseSet, from that midnight.

    Twilights and noon are the same definition: 1 s (its search stops there). Its sunrise has
    34' of refraction and the true semidiameter, ours 34.6' (of 10 deg C) and the mean one,
    0.3' off at most: 0.9' of elevation between them, 12 s at latitude 60 in midsummer.
    """
    zone = ZoneInfo("Etc/GMT-1")
    found = sun_events(day, latitude, 15.0, time_zone=zone)
    start = to_almanac(datetime(day.year, day.month, day.day, tzinfo=zone))
    observer = astronomy.Observer(latitude, 15.0, 0.0)
    sun, rise, set_ = astronomy.Body.Sun, astronomy.Direction.Rise, astronomy.Direction.Set
    noon = astronomy.SearchHourAngle(sun, observer, 0.0, start).time
    assert apart_s(found.noon, from_almanac(noon)) < 1.0
    for direction, ours in ((rise, found.sunrise), (set_, found.sunset)):
        almanacs = from_almanac(astronomy.SearchRiseSet(sun, observer, direction, start, 1.0))
        elevations = [sun_position(when, latitude, 15.0).elevation_rad for when in (ours, almanacs)]
        assert np.degrees(abs(np.subtract(*elevations))) * 60 < 0.95
        assert apart_s(ours, almanacs) < 15.0
    for name, altitude in TWILIGHTS.items():
        for direction, part in ((rise, "dawn"), (set_, "dusk")):
            almanacs = from_almanac(
                astronomy.SearchAltitude(sun, observer, direction, start, 1.0, altitude)
            )
            ours = getattr(found, f"{name}_{part}")
            assert (ours is None) == (almanacs is None)
            assert ours is None or apart_s(ours, almanacs) < 1.0


def test_a_published_day():
    """London at midsummer: 4:43 and 21:21 BST in every almanac, and no astronomical night."""
    found = sun_events(date(2026, 6, 21), 51.5074, -0.1278, time_zone=ZoneInfo("Europe/London"))
    assert found.sunrise.strftime("%H:%M") == "04:43"
    assert found.sunset.strftime("%H:%M") in ("21:21", "21:22")
    assert found.astronomical_dawn is None


@given(
    st.dates(date(1950, 1, 1), date(2079, 12, 31)),
    st.floats(-90, 90),
    st.floats(-180, 180),
    st.integers(-12, 14),
)
@example(date(2026, 6, 21), 90.0, 0.0, 0)
@example(date(2026, 12, 21), -90.0, 123.0, 0)
@example(date(2026, 3, 20), 90.0, -180.0, 12)
@example(date(2026, 6, 2), 66.0, 180.0, 12)
@example(date(2026, 11, 21), 69.65, 18.96, 1)
def test_each_event_is_where_the_sun_says(day, latitude, longitude, zone_hours):
    """At the instant given the limb is on the horizon, the centre at -6, -12, -18, or south.

    To 0.01 s of the sun's motion: 1e-6 rad. All lie within the civil day, in its own zone.
    """
    zone = timezone(timedelta(hours=zone_hours))
    found = sun_events(day, latitude, longitude, time_zone=zone)
    for name, when in zip(NAMES, astuple(found), strict=True):
        if when is None:
            continue
        assert when.utcoffset() == timedelta(hours=zone_hours)
        assert when.date() == day or when == datetime.combine(
            day + timedelta(days=1), datetime.min.time(), zone
        )
        sun = sun_position(when, latitude, longitude)
        if name == "noon":
            assert abs(sun.direction[0]) < 2e-6
        elif name in ("sunrise", "sunset"):
            limb = sun.elevation_rad + MEAN_ANGULAR_RADIUS_RAD
            assert limb + refraction_of_true_rad(limb) == pytest.approx(0.0, abs=2e-6)
        else:
            expected = np.radians(TWILIGHTS[name.split("_")[0]])
            assert sun.elevation_rad == pytest.approx(expected, abs=2e-6)


@given(st.dates(date(1950, 1, 1), date(2079, 12, 31)), st.floats(-60, 60), st.floats(-180, 180))
def test_a_day_in_its_own_solar_time_is_in_order(day, latitude, longitude):
    """Where the zone follows the sun: dawns, sunrise, noon, sunset, dusks, each after the last."""
    zone = timezone(timedelta(seconds=round(longitude * 240)))
    found = sun_events(day, latitude, longitude, time_zone=zone)
    there = [when for when in astuple(found) if when is not None]
    assert there == sorted(there)
    assert None not in (found.sunrise, found.noon, found.sunset)
    middle = found.sunrise + (found.sunset - found.sunrise) / 2
    assert abs(found.noon - middle) < timedelta(minutes=4)


@pytest.mark.parametrize("latitude", [70.0, 80.0, 89.99, 90.0])
def test_midnight_sun_and_polar_night(latitude):
    """In June it neither rises nor sets, in December there is not even civil twilight at 80."""
    summer = sun_events(date(2026, 6, 21), latitude, 25.0)
    assert summer.sunrise is summer.sunset is summer.civil_dawn is None
    assert summer.noon is not None
    winter = sun_events(date(2026, 12, 21), latitude, 25.0)
    assert winter.sunrise is winter.sunset is None
    assert (winter.civil_dawn is None) == (latitude > 75.0)


def test_at_the_pole_the_sun_rises_once_a_year():
    """A few days before the equinox, for refraction and radius lift it 0.85 deg."""
    days = [date(2026, 3, 15) + timedelta(days=i) for i in range(10)]
    risen = [day for day in days if sun_events(day, 90.0, 0.0).sunrise is not None]
    assert len(risen) == 1
    assert date(2026, 3, 17) <= risen[0] <= date(2026, 3, 19)


def test_the_first_and_the_last_glimpse_of_the_sun():
    """A grazing noon, up for some minutes only, hides between two looks: it must be found."""
    lengths = []
    for day in range(10, 31):
        found = sun_events(date(2026, 11, day), 69.6492, 18.9553, time_zone=ZoneInfo("Etc/GMT-1"))
        if found.sunrise is None:
            lengths.append(timedelta(0))
        else:
            lengths.append(found.sunset - found.sunrise)
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[-1] == timedelta(0)
    assert timedelta(0) < min(length for length in lengths if length) < timedelta(minutes=75)


def test_both_sides_of_the_date_line_are_one_place():
    """Longitude 180 east is 180 west."""
    east, west = (sun_events(date(2026, 9, 1), -17.0, x, time_zone=UTC) for x in (180.0, -180.0))
    for a, b in zip(astuple(east), astuple(west), strict=True):
        assert apart_s(a, b) < 0.05


def test_a_day_of_daylight_saving_has_23_hours():
    """Prague on 2026-03-29: the events are those of the true day, told in its own clock."""
    zone = ZoneInfo("Europe/Prague")
    found = sun_events(date(2026, 3, 29), *PRAGUE, time_zone=zone)
    assert found.astronomical_dawn.utcoffset() == timedelta(hours=2)
    assert found.noon.strftime("%H:%M") == "13:06"


def test_a_height_has_thinner_air_and_no_dip():
    """At 3000 m refraction is a third less: the sun rises later by up to a minute, not earlier."""
    low = sun_events(date(2026, 4, 10), 45.0, 7.0).sunrise
    high = sun_events(date(2026, 4, 10), 45.0, 7.0, altitude_m=3000.0).sunrise
    assert timedelta(0) < high - low < timedelta(seconds=90)


def test_the_short_series_serves_too():
    """The thesis's method puts noon within minutes of the ephemeris's."""
    ours = sun_events(date(2026, 5, 1), *PRAGUE).noon
    short = sun_events(date(2026, 5, 1), *PRAGUE, method="preetham").noon
    assert apart_s(ours, short) < 120


def test_a_place_off_the_earth_is_refused():
    """The error is one sentence, the same as that of sun_position."""
    with pytest.raises(ValueError, match="latitude_deg must lie between"):
        sun_events(date(2026, 5, 1), 91.0, 0.0)


@pytest.mark.parametrize(
    ("latitude", "longitude", "sunset", "sunrise"),
    [(65.72, -2.0, "00:06", "00:12")],
)
def test_an_event_minutes_after_midnight_is_found(latitude, longitude, sunset, sunrise):
    """The sun dips for six minutes around solar midnight, which falls just after the day's start.

    Instants to the minute from a scan of `sun_position` every ten seconds.
    """
    events = sun_events(date(2026, 6, 21), latitude, longitude)
    assert events.sunrise.strftime("%H:%M") == sunrise
    first_dip = sun_position(datetime(2026, 6, 21, 0, 9, tzinfo=UTC), latitude, longitude)
    limb = first_dip.elevation_rad + MEAN_ANGULAR_RADIUS_RAD
    assert limb + refraction_of_true_rad(limb) < 0.0
    assert events.sunset is not None

"""The sun's position and events all over the Earth, 1900 to 2100, and functions of elevation."""

import math
from datetime import UTC, date, datetime, timedelta, timezone
from itertools import pairwise

import numpy as np
import pytest
from dynamic_skylight import sun_events, sun_position
from dynamic_skylight.sun_step import sun_step_rad
from dynamic_skylight.twilight_curve import illuminance_lx
from stress_cases import assert_continuous, assert_finite, assert_light, assert_rising

from vrut_lite.atmosphere.refraction import (
    geometric_elevation,
    pressure_at_altitude_pa,
    refraction_of_true_rad,
)
from vrut_lite.sky.visible_disc import MEAN_ANGULAR_RADIUS_RAD, visible_fraction

EPOCH, DAYS = datetime(1900, 1, 1, tzinfo=UTC), 73_414
# Around the leap seconds at the ends of 1972, 1998, 2005 and 2016, and special dates.
NEIGHBOURS = [
    datetime(*moment, tzinfo=UTC)
    for moment in (
        (1900, 1, 1), (1900, 2, 28, 23, 59, 59, 999999), (1900, 3, 1),
        (1972, 12, 31, 23, 59, 59, 999999), (1973, 1, 1), (1998, 12, 31, 23, 59, 59), (1999, 1, 1),
        (2000, 2, 29, 12), (2005, 12, 31, 23, 59, 59, 500000), (2006, 1, 1),
        (2016, 12, 31, 23, 59, 59, 999999), (2017, 1, 1), (2100, 2, 28, 23, 59, 59), (2100, 12, 31),
    )
]  # fmt: skip
# Upper bound of the sun's speed: the sidereal rotation plus 2 % for its own motion.
FASTEST_RAD_PER_S = 1.02 * 2.0 * math.pi / 86_164.0


def instants(stress, count):
    """Aware datetimes over 200 years, some at `NEIGHBOURS` and a microsecond beside them."""
    for at in stress.random.uniform(0.0, DAYS, count):
        if stress.random.random() < 0.3:
            aside = timedelta(microseconds=int(stress.random.integers(-1, 2)))
            yield stress.random.choice(NEIGHBOURS) + aside
        else:
            yield EPOCH + timedelta(days=float(at))


def places(stress, count):
    """Latitudes and longitudes, poles, tropics, equator and date line among them."""
    latitudes = stress.within(count, -90.0, 90.0, [0.0, 23.4393, -23.4393, 66.56, -66.56])
    longitudes = stress.within(count, -180.0, 180.0, [0.0])
    return zip(latitudes.tolist(), longitudes.tolist(), strict=True)


@pytest.mark.parametrize("method", ["ephemeris", "preetham"])
def test_sun_position_is_one_direction(stress, method):
    """For any instant and place, ground to orbit: a unit vector, each number in its range."""
    for count in stress.batches(f"sun_position ({method})", 3000):
        for when, (latitude, longitude) in zip(
            instants(stress, count), places(stress, count), strict=True
        ):
            altitude = float(stress.random.choice([0.0, 1e-6, 8848.0, 400_000.0, 3.6e7, -430.0]))
            sun = sun_position(when, latitude, longitude, method, altitude_m=altitude)
            angles = (sun.elevation_rad, sun.apparent_elevation_rad, sun.azimuth_rad)
            assert_finite(np.array([*angles, *sun.direction]), f"{when} {latitude} {longitude}")
            assert -math.pi / 2 <= sun.elevation_rad <= sun.apparent_elevation_rad
            assert sun.apparent_elevation_rad <= math.pi / 2
            assert 0.0 <= sun.azimuth_rad < 2.0 * math.pi
            assert 0.0 <= sun.visible_disc_fraction <= 1.0
            assert math.hypot(*sun.direction) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("method", ["ephemeris", "preetham"])
def test_the_sun_moves_as_fast_as_the_sky_turns(stress, method):
    """Within 100 us the sun moves no farther than `FASTEST_RAD_PER_S` allows.

    Jumps at days, years, leap seconds and the date line would show. Below 1e-9
    rad a double of the days since 2000 has no more digits; the short series is taken within a
    calendar year, at whose end it jumps by its own error (0.001 rad).
    """
    step = timedelta(microseconds=100)
    most = FASTEST_RAD_PER_S * step.total_seconds() + 3e-10
    for count in stress.batches(f"sun_position ({method})", 1000):
        for when, (latitude, longitude) in zip(
            instants(stress, count), places(stress, count), strict=True
        ):
            if method == "preetham" and when.year != (when + step).year:
                continue
            before, after = (
                np.array(geometric(at, latitude, longitude, method)) for at in (when, when + step)
            )
            assert np.linalg.norm(after - before) <= most, f"{when} {latitude} {longitude}"


def geometric(when, latitude, longitude, method):
    """The unit vector of the airless sun."""
    sun = sun_position(when, latitude, longitude, method, pressure_pa=0.0)
    return sun.direction


@pytest.mark.parametrize("method", ["ephemeris", "preetham"])
def test_the_date_line_is_no_line(stress, method):
    """180 E and 180 W agree, and near a pole all longitudes have the same elevation."""
    for count in stress.batches(f"sun_position ({method})", 300):
        for when, (latitude, _) in zip(instants(stress, count), places(stress, count), strict=True):
            east, west = (sun_position(when, latitude, side, method) for side in (180.0, -180.0))
            assert np.allclose(east.direction, west.direction, rtol=0.0, atol=1e-9)
            pole = math.copysign(90.0, latitude)
            polar = [
                sun_position(when, pole, turn, method).elevation_rad for turn in (-77.0, 140.0)
            ]
            assert polar[0] == pytest.approx(polar[1], abs=1e-9)


def test_the_zone_does_not_matter(stress):
    """The same instant in two time zones gives the same bits."""
    for count in stress.batches("sun_position (ephemeris)", 100):
        for when in instants(stress, count):
            if when.year < 1901:
                continue
            zone = timezone(timedelta(minutes=int(stress.random.integers(-839, 840))))
            here, there = (sun_position(at, 50.0, 14.0) for at in (when, when.astimezone(zone)))
            assert here == there


def test_events_come_in_order(stress):
    """Dawns, sunrise, noon, sunset and dusks come in this order, if they exist.

    At any latitude, also at the poles, on the date line and on the days of leap seconds. An event
    may come twice in a day of the zone: then only its own two are compared.
    """
    dawn = ["astronomical_dawn", "nautical_dawn", "civil_dawn", "sunrise"]
    for count in stress.batches("sun_events", 8):
        for when, (latitude, longitude) in zip(
            instants(stress, count), places(stress, count), strict=True
        ):
            day = date(when.year, when.month, when.day)
            zone = timezone(timedelta(hours=round(longitude / 15.0)))
            found = sun_events(day, latitude, longitude, time_zone=zone)
            for earlier, later in pairwise(dawn):
                first, second = getattr(found, earlier), getattr(found, later)
                if first and second and abs(latitude) < 48.0:
                    assert first < second
            for event in vars(found).values():
                assert event is None or event.utcoffset() is not None
                assert event is None or event.date() in (day, day + timedelta(days=1))


ELEVATIONS = [0.0, -np.radians(1.0), -np.radians(6.0), np.radians(0.5), MEAN_ANGULAR_RADIUS_RAD]


def test_refraction_is_smooth_and_never_lowers(stress):
    """Finite, not negative, continuous from nadir to zenith; apparent elevation is monotone."""
    for count in stress.batches("refraction_of_true_rad", 400_000):
        elevation = stress.within(count, -np.pi / 2, np.pi / 2, ELEVATIONS)
        assert_light(refraction_of_true_rad(elevation))
        assert_continuous(refraction_of_true_rad, elevation)
        rising = np.sort(elevation)
        assert_rising(rising + refraction_of_true_rad(rising), 1e-15)


def test_refraction_is_undone(stress):
    """The inverse is right to 1e-12 rad."""
    for count in stress.batches("geometric_elevation", 20_000):
        elevation = stress.within(count, -np.pi / 2, np.pi / 2, ELEVATIONS)
        back = geometric_elevation(elevation + refraction_of_true_rad(elevation))
        assert np.abs(back - elevation).max() <= 1e-12


def test_pressure_falls(stress):
    """From -5 km to the moon pressure is finite, not negative, falling, continuous at 11 km."""
    for count in stress.batches("pressure_at_altitude_pa", 2000):
        altitude = np.sort(stress.within(count, -5000.0, 4e8, [0.0, 11_000.0]))
        pressure = np.array([pressure_at_altitude_pa(float(h)) for h in altitude])
        assert_light(pressure)
        assert_rising(-pressure)
    below, above = (pressure_at_altitude_pa(11_000.0 + side) for side in (-1e-6, 1e-6))
    assert below == pytest.approx(above, rel=1e-5)


def test_the_disc_sets_evenly(stress):
    """The visible share is in [0, 1], 1/2 at the horizon, and grows with elevation."""
    marks = [0.0, MEAN_ANGULAR_RADIUS_RAD, -MEAN_ANGULAR_RADIUS_RAD, 1e-9, -1e-9]
    for count in stress.batches("visible_fraction", 400_000):
        elevation = np.sort(stress.within(count, -np.pi / 2, np.pi / 2, marks))
        share = visible_fraction(elevation)
        assert_light(share)
        assert share.max() <= 1.0
        assert_rising(share, 1e-15)
        assert_continuous(visible_fraction, elevation)
    assert float(visible_fraction(0.0)) == 0.5


def test_twilights_curve_only_rises(stress):
    """The published illuminance grows with elevation, and its pieces meet."""
    for count in stress.batches("illuminance_lx", 400_000):
        elevation = stress.within(count, -90.0, 90.0, [-18.0, -12.0, -5.0, -0.8, 5.0, 20.0])
        assert_light(illuminance_lx(elevation))
        assert_continuous(illuminance_lx, elevation, floor=1e-9)
        assert_rising(illuminance_lx(np.sort(elevation)), 1e-9)


def test_the_suns_step_is_a_step(stress):
    """Positive and finite for every elevation: a zero step would redraw without end."""
    for count in stress.batches("sun_step_rad", 2000):
        for elevation in stress.within(count, -np.pi / 2, np.pi / 2, [0.0, np.radians(7.0)]):
            assert 1e-6 < sun_step_rad(float(elevation)) < 0.1

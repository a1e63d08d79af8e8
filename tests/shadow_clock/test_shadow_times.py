"""The times of a shadow, against the ephemeris and against NREL's solar position algorithm."""

from datetime import UTC, date, datetime, timedelta

import numpy as np
import pytest
from dynamic_skylight import sun_position
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shadow_clock.measured_shadow import MeasuredShadow
from shadow_clock.times import ShadowDays

from vrut_lite.place_time import Place
from vrut_lite.sky.visible_disc import MEAN_ANGULAR_RADIUS_RAD

PRAGUE = Place(50.0755, 14.4378, 200.0)
# Poles, both sides of the date line, tropics where the sun turns back or passes the zenith, polar
# days and nights.
NOTABLE = [
    (90.0, 0.0), (-90.0, 77.0), (89.9, 10.0), (0.0, 180.0), (0.0, -180.0), (10.0, 20.0),
    (-15.0, -70.0), (23.43, 100.0), (78.2, 15.6), (-77.85, 166.67), (-33.9, 18.4),
]  # fmt: skip
latitudes, longitudes = st.floats(-90.0, 90.0), st.floats(-180.0, 180.0)
places = st.one_of(st.sampled_from(NOTABLE), st.tuples(latitudes, longitudes))


def seen(instant, place):
    """Bearing and length ratio of a shadow by the ephemeris, and the sun."""
    sun = sun_position(instant, *place[:2], altitude_m=(*place, 0.0)[2])
    bearing = (np.degrees(sun.azimuth_rad) + 180.0) % 360.0
    return bearing, 1.0 / np.tan(sun.apparent_elevation_rad), sun


def turned_deg(a, b):
    return abs((a - b + 180.0) % 360.0 - 180.0)


@settings(max_examples=25, deadline=None)
@given(place=places, day=st.dates(date(1900, 1, 1), date(2100, 12, 31)),
       second=st.floats(2.0, 86_397.0))  # fmt: skip
def test_the_instant_of_a_shadow_is_found_again(place, day, second):
    """Bearing, ratio and both name the instant to a second, wherever the sun moves at all."""
    instant = datetime(day.year, day.month, day.day, tzinfo=UTC) + timedelta(seconds=second)
    bearing, ratio, sun = seen(instant, place)
    assume(np.radians(0.5) < sun.apparent_elevation_rad < np.radians(89.9))
    days = ShadowDays(day, day, Place(*place), UTC)
    nearby = [seen(instant + timedelta(seconds=side), place) for side in (-1.0, 1.0)]
    turns = min(turned_deg(one[0], bearing) for one in nearby) > 1e-6
    climbs = min(abs(one[2].elevation_rad - sun.elevation_rad) for one in nearby) > 2e-8
    told = {(bearing, None): turns, (None, ratio): climbs, (bearing, ratio): turns or climbs}
    for one in (measured for measured, moves in told.items() if moves):
        found = days.times(MeasuredShadow(*one, 1.0, 0.02))
        off = [abs((time.instant - instant).total_seconds()) for time in found]
        assert min(off) < 1.0, one
        nearest = found[int(np.argmin(off))]
        assert nearest.earliest < instant < nearest.latest
        assert nearest.misfit < 0.01


def test_times_agree_with_nrel():
    """SPA and its refraction (Reda and Andreas 2004) are another program, to a few seconds."""
    solar = pytest.importorskip("pvlib.solarposition")
    pandas = pytest.importorskip("pandas")
    cases = [
        (PRAGUE, datetime(2026, 6, 21, 9, 17, tzinfo=UTC)),
        (Place(-33.92, 18.42), datetime(2026, 12, 3, 15, 40, tzinfo=UTC)),
        (Place(69.65, 18.96), datetime(2026, 5, 30, 23, 10, tzinfo=UTC)),
        (Place(1.35, 103.82), datetime(2026, 3, 9, 2, 30, tzinfo=UTC)),
    ]
    for place, instant in cases:
        spa = solar.spa_python(
            pandas.DatetimeIndex([instant]), place.latitude_deg, place.longitude_deg,
            altitude=place.altitude_m, temperature=10.0, delta_t=None,
        ).iloc[0]  # fmt: skip
        bearing = (spa["azimuth"] + 180.0) % 360.0
        ratio = 1.0 / np.tan(np.radians(spa["apparent_elevation"]))
        days = ShadowDays(instant.date(), instant.date(), place, UTC)
        for measured in ((bearing, None), (None, ratio), (bearing, ratio)):
            found = days.times(MeasuredShadow(*measured))
            off = min(abs((one.instant - instant).total_seconds()) for one in found)
            assert off < 3.0, (place, measured, off)


def test_a_bearing_comes_twice_in_a_tropical_morning():
    """At 10 N in June the sun rises at 66 degrees, turns back at 68.7 and passes noon in the north:
    sin A = cos declination / cos latitude at the turn."""
    place = Place(10.0, 20.0)
    days = ShadowDays(date(2026, 6, 21), date(2026, 6, 21), place, UTC)
    found = days.times(MeasuredShadow(247.5, None, 0.1))
    assert [one.instant.hour < 10 for one in found] == [True, True]
    assert [seen(one.instant, place)[0] for one in found] == pytest.approx([247.5] * 2, abs=1e-4)
    assert len(days.times(MeasuredShadow(240.0, None, 0.1))) == 1
    assert days.times(MeasuredShadow(250.0, None, 0.1)) == []
    assert "no shadow ever points to 250" in days.why_none(MeasuredShadow(250.0, None, 0.1))


def test_the_span_ends_where_the_measured_error_does():
    """Its ends differ from the bearing by the error and the disc's half width, levelled."""
    days = ShadowDays(date(2026, 6, 21), date(2026, 6, 21), PRAGUE, UTC)
    (found,) = days.times(MeasuredShadow(312.0, None, 1.5))
    for end in (found.earliest, found.latest):
        bearing, _, sun = seen(end, PRAGUE)
        width = np.arcsin(MEAN_ANGULAR_RADIUS_RAD / np.cos(sun.apparent_elevation_rad))
        assert turned_deg(bearing, 312.0) == pytest.approx(1.5 + np.degrees(width), abs=1e-4)
    (morning, _) = days.times(MeasuredShadow(None, 1.2, ratio_error=0.1))
    for end, ratio, sign in ((morning.earliest, 1.32, -1.0), (morning.latest, 1.08, 1.0)):
        sun = seen(end, PRAGUE)[2]
        blur = sun.apparent_elevation_rad - np.arctan2(1.0, ratio)
        # The disc, and a quarter of a minute of arc of refraction.
        assert np.degrees(sign * blur) == pytest.approx(0.2666 + 0.28 * 0.0195, abs=1e-3)


def test_a_ratio_just_missed_at_noon_is_told_with_its_misfit():
    """A shadow measured a little too short fits noon, within the error."""
    days = ShadowDays(date(2026, 6, 21), date(2026, 6, 21), PRAGUE, UTC)
    (found,) = days.times(MeasuredShadow(None, 0.5))
    assert 0.0 < found.misfit < 0.1
    assert found.bearing_deg % 360.0 == pytest.approx(360.0, abs=0.1)
    assert (found.latest - found.earliest) > timedelta(hours=1)


def test_each_day_of_a_range_has_its_times():
    """A range counts every civil day once, also those of changed clocks."""
    days = ShadowDays(date(2026, 1, 1), date(2026, 12, 31), PRAGUE, UTC)
    found = days.times(MeasuredShadow(0.0, None))
    assert len(found) == 365
    assert len({one.instant.date() for one in found}) == 365

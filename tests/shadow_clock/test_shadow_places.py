"""The places of a shadow, against the ephemeris, and an example of another program."""

import json
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from dynamic_skylight import sun_position
from shadow_clock.geojson import line_feature
from shadow_clock.measured_shadow import MeasuredShadow
from shadow_clock.places import EarthLine, ShadowCircle

from vrut_lite.sky.visible_disc import MEAN_ANGULAR_RADIUS_RAD

AT = datetime(2026, 6, 21, 15, tzinfo=UTC)
EARTH_KM = 6371.0


@pytest.mark.parametrize("ratio", [0.02, 1.2, 30.0])
def test_the_sun_has_its_elevation_all_along_the_line(ratio):
    """Within 0.001 degrees by the ephemeris, with refraction and parallax."""
    line = ShadowCircle(MeasuredShadow(None, ratio), AT).line()
    for latitude, longitude in list(zip(*line, strict=True))[::60]:
        sun = sun_position(AT, latitude, longitude)
        off = sun.apparent_elevation_rad - np.arctan2(1.0, ratio)
        assert abs(np.degrees(off)) < 0.001


@pytest.mark.parametrize("ratio", [0.3, 1.2, 8.0])
@pytest.mark.parametrize("bearing", [0.0, 41.0, 120.0, 200.0, 330.0])
def test_a_place_has_the_measured_bearing(ratio, bearing):
    """Each place that is told has bearing and ratio by the ephemeris, and no error of none."""
    for place in ShadowCircle(MeasuredShadow(bearing, ratio), AT).places():
        sun = sun_position(AT, place.latitude_deg, place.longitude_deg)
        assert 1.0 / np.tan(sun.apparent_elevation_rad) == pytest.approx(ratio, rel=1e-4)
        turned = (np.degrees(sun.azimuth_rad) + 180.0 - bearing + 180.0) % 360.0 - 180.0
        assert abs(turned) < (1e-4 if place.bearing_deg == pytest.approx(bearing) else 5.0)
        assert place.error_km > 30.0


def test_a_known_place_is_found_again():
    """From its own shadow, wherever on Earth the sun shines at that instant."""
    random = np.random.default_rng(5)
    known = 0
    while known < 6:
        latitude = np.degrees(np.arcsin(random.uniform(-1.0, 1.0)))
        longitude = random.uniform(-180.0, 180.0)
        sun = sun_position(AT, latitude, longitude)
        if not np.radians(2.0) < sun.apparent_elevation_rad < np.radians(89.0):
            continue
        known += 1
        bearing = (np.degrees(sun.azimuth_rad) + 180.0) % 360.0
        shadow = MeasuredShadow(bearing, 1.0 / np.tan(sun.apparent_elevation_rad))
        found = ShadowCircle(shadow, AT).places()
        away = [apart_km(one.latitude_deg, one.longitude_deg, latitude, longitude) for one in found]
        assert 1 <= len(found) <= 2
        assert min(away) < 0.1


def apart_km(latitude, longitude, other_latitude, other_longitude):
    a, b = (
        np.array([np.cos(p) * np.cos(q), np.cos(p) * np.sin(q), np.sin(p)])
        for p, q in np.radians([[latitude, longitude], [other_latitude, other_longitude]])
    )
    return 2.0 * EARTH_KM * np.arcsin(0.5 * np.linalg.norm(a - b))


def test_the_error_of_a_place_reaches_as_far_as_places_fit():
    """Places tried one by one by the ephemeris: the farthest that fits is as far as told."""
    shadow = MeasuredShadow(41.0, 1.2, 2.0, 0.05)
    (found,) = ShadowCircle(shadow, AT).places()
    low, high = np.arctan2(1.0, 1.26), np.arctan2(1.0, 1.14)
    farthest = 0.0
    for latitude in np.arange(66.0, 73.0, 0.2):
        for longitude in np.arange(-20.0, -2.0, 0.4):
            sun = sun_position(AT, latitude, longitude)
            elevation = sun.apparent_elevation_rad
            blur = MEAN_ANGULAR_RADIUS_RAD
            room = 2.0 + np.degrees(blur / np.cos(elevation))
            off = abs(np.degrees(sun.azimuth_rad) + 180.0 - 360.0 - 41.0)
            if low - blur < elevation < high + blur and off < room:
                away = apart_km(found.latitude_deg, found.longitude_deg, latitude, longitude)
                farthest = max(farthest, away)
    assert found.error_km == pytest.approx(farthest, rel=0.06)


def test_the_band_holds_what_an_error_of_time_leaves_open():
    """A shadow ten minutes later fits if the time may be off by eleven, else not."""
    later = AT + timedelta(minutes=10)
    shadow = MeasuredShadow(None, 1.2, ratio_error=0.0)
    line = ShadowCircle(shadow, later).line()
    assert ShadowCircle(shadow, AT, 660.0).misfit(*line).max() < 1.0
    assert ShadowCircle(shadow, AT, 0.0).misfit(*line).max() > 1.0


def test_shadowfinders_example_lies_in_its_band():
    """`shadowfinder find 10 5 2024-02-29 13:59:59`: its shadow lengths by the formulas of suncalc
    (mourner, after aa.quae.nl) are ours within a percent all along the line; its band is 20 %."""
    at = datetime(2024, 2, 29, 13, 59, 59, tzinfo=UTC)
    line = ShadowCircle(MeasuredShadow(None, 0.5), at).line()
    days = at.timestamp() / 86_400.0 - 0.5 + 2_440_588.0 - 2_451_545.0
    anomaly = np.radians(357.5291 + 0.98560028 * days)
    centre = np.radians(
        1.9148 * np.sin(anomaly) + 0.02 * np.sin(2 * anomaly) + 0.0003 * np.sin(3 * anomaly)
    )
    ecliptic = anomaly + centre + np.radians(102.9372) + np.pi
    tilt = np.radians(23.4397)
    declination = np.arcsin(np.sin(tilt) * np.sin(ecliptic))
    ascension = np.arctan2(np.sin(ecliptic) * np.cos(tilt), np.cos(ecliptic))
    latitude, longitude = (np.radians(part) for part in line)
    hour_angle = np.radians(280.16 + 360.9856235 * days) + longitude - ascension
    sine = np.sin(latitude) * np.sin(declination)
    sine += np.cos(latitude) * np.cos(declination) * np.cos(hour_angle)
    lengths = 10.0 / np.tan(np.arcsin(sine))
    assert lengths == pytest.approx(np.full(lengths.shape, 5.0), rel=0.01)


def test_geojson_cuts_lines_at_the_date_line():
    """Other programs draw a segment from 179 to -179 through Greenwich (RFC 7946, 3.1.9)."""
    crossing = EarthLine(np.array([10.0, 12.0, 14.0]), np.array([178.0, -178.0, -170.0]))
    feature = json.loads(json.dumps(line_feature(crossing, what="line")))
    first, second = feature["geometry"]["coordinates"]
    assert first == [[178.0, 10.0], [180.0, 11.0]]
    assert second == [[-180.0, 11.0], [-178.0, 12.0], [-170.0, 14.0]]

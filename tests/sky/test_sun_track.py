"""The array ephemeris against the scalar one, which tests compare with NREL's SPA."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from dynamic_skylight import sun_position

from vrut_lite.sky.sun_track import SunTrack


@pytest.mark.parametrize("year", [1601, 1950, 2026, 2598])
def test_arrays_agree_with_the_ephemeris(year):
    """Interpolation adds no error that a user could notice: 1e-6 degrees of a great circle."""
    random = np.random.default_rng(year)
    start = datetime(year, 1, 1, tzinfo=UTC)
    seconds = start.timestamp() + random.uniform(0.0, 40.0 * 86_400.0, 12)
    track = SunTrack(seconds.min(), seconds.max())
    for second in seconds:
        when = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(seconds=float(second))
        latitude, longitude = random.uniform(-90.0, 90.0), random.uniform(-180.0, 180.0)
        true = sun_position(when, latitude, longitude, altitude_m=2000.0)
        found = track.suns(second, latitude, longitude, 2000.0)
        turned = np.angle(np.exp(1j * (found.azimuth_rad - true.azimuth_rad)))
        off = [
            found.elevation_rad - true.elevation_rad,
            found.apparent_elevation_rad - true.apparent_elevation_rad,
            turned * np.cos(true.elevation_rad),
        ]
        assert np.degrees(np.abs(off)).max() < 1e-6


def test_instants_and_places_broadcast():
    """A map asks for many places at one instant, a day for many instants at one place."""
    at = datetime(2026, 6, 21, 12, tzinfo=UTC).timestamp()
    track = SunTrack(at, at + 3600.0)
    suns = track.suns(at + np.array([0.0, 3600.0])[:, None], np.array([10.0, 20.0, 30.0]), 5.0)
    assert suns.azimuth_rad.shape == (2, 3)
    alone = track.suns(at + 3600.0, 20.0, 5.0)
    assert suns.elevation_rad[1, 1] == pytest.approx(float(alone.elevation_rad), abs=1e-15)

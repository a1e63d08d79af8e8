"""Where the sun stood: computed, and as the sky itself tells."""

from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest
from dynamic_skylight import sun_position

from vrut_lite_lab.study.framework.day import KIDER
from vrut_lite_lab.study.framework.directions import directions
from vrut_lite_lab.study.framework.sun_azimuth import estimated_sun_azimuth
from vrut_lite_lab.study.framework.sun_coordinates import sun_coordinates

EDT = timezone(timedelta(hours=-4))


def test_sun_coordinates_are_the_published_ones(reference):
    """The 17 steps from 9:30 to 13:30, to 1e-9 deg."""
    first = datetime(2013, 5, 27, 9, 30, tzinfo=EDT)
    steps = [first + timedelta(minutes=15 * k) for k in range(17)]
    ours = [sun_coordinates(when, KIDER.latitude_deg, KIDER.longitude_deg) for when in steps]
    np.testing.assert_allclose(np.degrees(ours), reference["sun_coordinates_deg"], atol=1e-9)


@pytest.mark.parametrize("latitude_deg", [-60.0, 5.0, 42.0])
def test_sun_coordinates_agree_with_the_ephemeris(latitude_deg):
    """Blanco-Muriel et al. promise 0.5 minutes of arc from 1999 to 2015."""
    when = datetime(2013, 9, 3, 15, 20, tzinfo=UTC)
    exact = sun_position(when, latitude_deg, 10.0)
    zenith, azimuth = sun_coordinates(when, latitude_deg, 10.0)
    assert abs(np.pi / 2 - zenith - exact.elevation_rad) < np.radians(0.5 / 60)
    turn = np.angle(np.exp(1j * (azimuth - exact.azimuth_rad))) * np.sin(zenith)
    assert abs(turn) < np.radians(0.5 / 60)


@pytest.mark.parametrize("sun_azimuth_deg", [3.0, 100.0, 359.0])
def test_the_azimuth_of_a_symmetric_sky_is_found(sun_azimuth_deg):
    """A glow around a sun 13 deg off the expected azimuth is found to within one step, 0.2 deg.

    The 81 directions do not lie symmetric to any azimuth, which alone would cost some tenths.
    """
    zenith, azimuth = directions()
    relative = azimuth - np.radians(sun_azimuth_deg)
    nu = np.cos(0.6) * np.cos(zenith) + np.sin(0.6) * np.sin(zenith) * np.cos(relative)
    sky = np.exp(nu)[:, None] * np.ones(40)
    found = estimated_sun_azimuth(sky, np.radians(sun_azimuth_deg + 13.0))
    assert 0.0 <= found < 2.0 * np.pi
    assert abs(np.degrees(np.angle(np.exp(1j * (found - np.radians(sun_azimuth_deg)))))) < 0.21

"""Refraction and the disc on the horizon."""

import numpy as np
import pytest

from vrut_lite.atmosphere.refraction import (
    geometric_elevation,
    pressure_at_altitude_pa,
    refraction_of_true_rad,
)
from vrut_lite.sky.visible_disc import MEAN_ANGULAR_RADIUS_RAD, visible_fraction

EVERYWHERE = np.radians(np.linspace(-90.0, 90.0, 18001))


def test_refraction_of_known_elevations():
    """Meeus, Astronomical Algorithms ch. 16: apparent 0.5 deg is 28.754' lifted.

    At the horizon a geometric 0 is lifted about 29', at 45 deg about 1'.
    """
    apparent = np.radians(0.5)
    lift = np.degrees(apparent - geometric_elevation(apparent)) * 60
    # The formula of the other direction; Meeus states 0.07' between the two, 1.01325/1.01 for air.
    assert lift == pytest.approx(28.754 * 1.01325 / 1.01, abs=0.2)
    assert np.degrees(refraction_of_true_rad(0.0)) * 60 == pytest.approx(29.0, abs=0.3)
    assert np.degrees(refraction_of_true_rad(np.radians(45.0))) * 60 == pytest.approx(1.0, abs=0.03)


def test_refraction_is_continuous_and_keeps_the_order_of_elevations():
    """From nadir to zenith no jump, and a higher sun never looks lower (slope within 0.2)."""
    slope = np.diff(refraction_of_true_rad(EVERYWHERE)) / np.diff(EVERYWHERE)
    assert np.all(np.abs(slope) < 0.2)


def test_refraction_is_gone_in_deep_twilight_and_never_negative():
    """Below -6 deg geometric and apparent agree; the zenith's fit may not push down."""
    refraction = refraction_of_true_rad(EVERYWHERE)
    assert refraction.min() == 0.0
    assert not refraction[np.radians(-6.0) >= EVERYWHERE].any()


def test_no_air_no_refraction():
    """Refraction scales with pressure, and inversely with absolute temperature."""
    assert refraction_of_true_rad(0.1, pressure_pa=0.0) == 0.0
    warm = refraction_of_true_rad(0.1, temperature_c=10.0 + 283.0)
    assert warm == pytest.approx(refraction_of_true_rad(0.1, temperature_c=10.0) / 2, rel=1e-9)


def test_geometric_elevation_inverts_refraction():
    """There and back must be the identity to 1e-12 rad."""
    apparent = EVERYWHERE + refraction_of_true_rad(EVERYWHERE)
    np.testing.assert_allclose(geometric_elevation(apparent), EVERYWHERE, atol=1e-12)


def test_standard_pressures():
    """ISO 2533: 101325 Pa at sea level, 54020 at 5 km, 22632 at 11 km, 5475 at 20 km."""
    for altitude, pressure in ((0, 101_325), (5e3, 54_020), (11e3, 22_632), (20e3, 5_475)):
        assert pressure_at_altitude_pa(altitude) == pytest.approx(pressure, rel=1e-3)


def test_the_disc_sets_evenly_about_its_centre():
    """Half is up at elevation 0, all above one radius, nothing below; a quarter's height 19.6 %."""
    r = MEAN_ANGULAR_RADIUS_RAD
    assert visible_fraction([-2 * r, -r, 0.0, r, 2 * r]) == pytest.approx([0, 0, 0.5, 1, 1])
    # A circle's segment with a height of half its radius: (acos(1/2) - sqrt(3)/4) / pi.
    assert visible_fraction(-r / 2) == pytest.approx((np.pi / 3 - np.sqrt(3) / 4) / np.pi)


def test_the_mean_radius_is_the_suns():
    """959.63 arc seconds at one astronomical unit (IAU), 0.2666 deg."""
    assert np.degrees(MEAN_ANGULAR_RADIUS_RAD) * 3600 == pytest.approx(959.63, rel=1e-4)

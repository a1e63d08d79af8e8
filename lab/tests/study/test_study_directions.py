"""The 81 directions and the smooth function through what is known in them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite_lab.study.framework.directions import directions, ring_order, ring_zenith_rad
from vrut_lite_lab.study.framework.interpolant import interpolate

azimuths = st.floats(-7.0, 14.0)
zeniths = st.floats(0.0, np.pi / 2)


def some_values(seed=1):
    """Numbers in the 81 directions."""
    return np.random.default_rng(seed).normal(size=81)


def test_directions_are_the_published_ones(reference):
    """Zenith angles, and azimuths up to whole turns."""
    zenith, azimuth = directions()
    np.testing.assert_allclose(zenith, reference["sample_zenith"], atol=1e-15)
    turn = np.angle(np.exp(1j * (azimuth - reference["sample_azimuth"])))
    np.testing.assert_allclose(turn, 0.0, atol=1e-14)


def test_rings_hold_all_directions_evenly():
    """Ring k has 8 k directions 45 / k deg apart, the first due north, all at one height."""
    zenith, azimuth = directions()
    rings = ring_order()
    assert sorted(np.concatenate(rings)) == list(range(81))
    elevation_deg = 90.0 - np.degrees(ring_zenith_rad())
    np.testing.assert_allclose(elevation_deg, [90, 71.9187, 53.3665, 33.749, 12.1151], atol=5e-5)
    for k, members in enumerate(rings[1:], start=1):
        np.testing.assert_allclose(np.degrees(azimuth[members]), np.arange(8 * k) * 45.0 / k)
        np.testing.assert_allclose(zenith[members], ring_zenith_rad()[k])


def test_interpolation_is_the_published_one(reference):
    """300 places, zenith to horizon, negative azimuths too."""
    values = interpolate(reference["interp_values"].ravel(), *reference["interp_query"].T)
    np.testing.assert_allclose(values, reference["interp_result"], atol=1e-13)


def test_interpolation_meets_what_it_was_given():
    """In the 81 directions themselves, for values of any shape."""
    values = some_values().reshape(81, 1, 1) * np.ones((1, 2, 3))
    np.testing.assert_allclose(interpolate(values, *directions()), values, atol=1e-13)


@given(zenith=zeniths, azimuth=azimuths)
def test_interpolation_keeps_constants_and_turns_with_its_values(zenith, azimuth):
    """A constant stays; values turned by 45 deg, a step of every ring, give a turned function."""
    np.testing.assert_allclose(interpolate(np.ones(81), zenith, azimuth), 1.0, rtol=1e-12)
    values, turned = some_values(), np.zeros(81)
    for k, members in enumerate(ring_order()):
        turned[members] = np.roll(values[members], k)
    there = interpolate(turned, zenith, azimuth + np.pi / 4)
    np.testing.assert_allclose(there, interpolate(values, zenith, azimuth), atol=1e-10)


@pytest.mark.parametrize("ring", [1, 2, 3, 4])
def test_interpolation_is_smooth_across_rings(ring):
    """Values and slopes meet at a ring: their jump over 2e-6 of a ring is of that order."""
    around, step = np.linspace(0.0, 6.0, 25), 1e-6

    def at(place):
        zenith = np.arccos(1.0 - (place / 4.5) ** 2)
        return interpolate(some_values(), zenith, around)

    before, here, after = at(ring - step), at(ring), at(ring + step)
    np.testing.assert_allclose(after - here, here - before, atol=3e-5 * step / 1e-6)
    np.testing.assert_allclose(after, before, atol=5e-5)

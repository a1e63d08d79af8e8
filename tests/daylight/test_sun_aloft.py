"""Sunlight at altitudes in the air and above it."""

import numpy as np
import pytest

from vrut_lite.daylight.sun_aloft import PLANET_RADIUS_M, sun_aloft
from vrut_lite.geometry.colour import rgb_from_spectrum, solar_irradiance

NM = (680.0, 550.0, 440.0)
WHOLE = np.maximum(rgb_from_spectrum(solar_irradiance(NM), NM, 0.0), 0.0)


@pytest.mark.parametrize("altitude_m", [80_000.0, 81_000.0, 4e5, 4e8])
def test_above_the_air_the_sun_is_whole(altitude_m):
    """Above the air an overhead sun is not dimmed, and a sun behind the planet gives no light."""
    assert sun_aloft(altitude_m, 1.0) == pytest.approx(WHOLE, rel=1e-9)
    assert not sun_aloft(altitude_m, -1.0).any()


def test_from_orbit_the_sun_sets_through_twice_the_air():
    """A ray that grazes the ground has twice the optical depth of one that starts there."""
    altitude_m = 4e5
    radius = PLANET_RADIUS_M + altitude_m
    grazing = -np.sqrt(1.0 - (PLANET_RADIUS_M / radius) ** 2)
    halves = [sun_aloft(height, mu) for height, mu in ((0.0, 0.0), (altitude_m, grazing))]
    from_ground, from_orbit = (half / (0.5 * WHOLE) for half in halves)
    assert from_orbit == pytest.approx(from_ground**2, rel=0.02)


def test_the_horizon_sinks_with_every_nanometre():
    """The dip of the horizon, sqrt(2 h / R), is precise: more and more of a level sun is visible.

    An arc cosine would have steps of 2e-8 rad: four of them in these fifty heights.
    """
    light = sun_aloft(np.linspace(1e-10, 2e-9, 50), 0.0)
    assert (np.diff(light, axis=0) > 0.0).all()

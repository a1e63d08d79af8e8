"""Refraction for an eye above the ground, up to space."""

import numpy as np
import pytest

from vrut_lite.atmosphere.refraction import (
    apparent_elevation,
    dip_rad,
    horizon_elevation,
    refraction_rad,
    seen_from_aloft,
    trace,
)

MINUTES = 60.0 * np.degrees(1.0)


@pytest.mark.parametrize("altitude_m", [5.0, 200.0, 3000.0, 11_500.0, 45_000.0])
def test_tables_aloft_are_within_a_fifth_of_a_minute_of_tracing(altitude_m):
    dip = dip_rad(altitude_m)
    at = np.concatenate([np.linspace(-dip, 0.05, 15), np.radians([3.0, 9.0, 30.0, 80.0])])
    off = np.abs(refraction_rad(at, altitude_m) - trace(at, altitude_m))
    assert off.max() * MINUTES < 0.2


@pytest.mark.parametrize("altitude_m", [4.0, 25.0, 400.0])
def test_the_dip_of_the_horizon_is_the_nautical_almanacs(altitude_m):
    # 1.76' times the root of the height in metres.
    assert dip_rad(altitude_m) * MINUTES == pytest.approx(1.76 * altitude_m**0.5, rel=0.01)


@pytest.mark.parametrize(
    ("lowest_m", "bent"), [(0, 67.6), (5000, 41.7), (10_000, 24.8), (20_000, 5.3)]
)
def test_from_space_a_ray_that_sinks_and_climbs_again_bends_twice(lowest_m, bent):
    # The bending by the lowest point, traced apart from this code.
    space_m = 400_000.0
    index = 1.0 + 2.818e-4 * np.exp(-lowest_m / 9300.0)
    down = np.arccos(min(index * (6_371_000.0 + lowest_m) / (6_371_000.0 + space_m), 1.0))
    down = min(down, dip_rad(space_m))
    assert float(refraction_rad(-down, space_m)) * MINUTES == pytest.approx(bent, abs=0.35)
    assert float(refraction_rad(0.01, space_m)) == 0.0


def test_an_eye_aloft_sees_a_sun_that_has_set_below():
    assert horizon_elevation(0.0) * MINUTES == pytest.approx(-33.9, abs=0.2)
    assert horizon_elevation(10_000.0) * MINUTES == pytest.approx(-180.5 - 62.8, abs=0.5)
    true = np.radians(-3.5)
    seen = seen_from_aloft((0.0, float(np.sin(true)), -float(np.cos(true))), float(true), 10_000.0)
    assert np.arcsin(seen[1]) == pytest.approx(float(apparent_elevation(true, 10_000.0)))
    assert np.arcsin(seen[1]) > -dip_rad(10_000.0)

"""Refracted paths to space: published air masses, straight rays, rays traced step by step."""

from functools import partial

import numpy as np
import pytest
from bruneton_sky import Atmosphere
from bruneton_sky.optical_path import optical_depth_to_top
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.atmosphere import clear_air
from vrut_lite.atmosphere.refraction import dip_rad
from vrut_lite.atmosphere.slant_path import BentAir, exponential, horizon_sine, slant_paths

# A planet a third as large, under air that bends twice as much: no constant of the Earth's.
SMALL = BentAir(2.0e6, 60_000.0, 5e-4, partial(exponential, 6000.0), (20_000.0,))


def kasten_and_young(elevation_deg):
    """Air mass by Kasten and Young 1989, of the apparent elevation (degrees)."""
    e = np.asarray(elevation_deg, dtype=float)
    return 1.0 / (np.sin(np.radians(e)) + 0.50572 * (e + 6.07995) ** -1.6364)


def test_air_masses_are_the_published_ones_down_to_the_horizon():
    elevation_deg = np.array([0.0, 0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 45.0, 90.0])
    sine = np.sin(np.radians(elevation_deg))
    paths = slant_paths(clear_air.STANDARD_AIR, 0.0, sine, [clear_air.molecule_density])
    assert paths[:, 0] / clear_air.COLUMN_M == pytest.approx(
        kasten_and_young(elevation_deg), rel=5e-3
    )


@pytest.mark.parametrize("altitude_m", [0.0, 1000.0, 30_000.0])
def test_without_refraction_a_path_is_that_of_straight_rays(altitude_m):
    """The solver's paths are integrated otherwise, in closed form."""
    air = Atmosphere.earth()
    straight = BentAir(
        air.ground_radius_m, air.top_altitude_m, 0.0, air.molecules, air.absorber_altitude_m
    )
    horizon = float(horizon_sine(straight, altitude_m))
    sine = np.array([horizon + 1e-9, 0.5 * horizon, 0.0, 1e-3, 0.02, 0.3, 1.0])
    densities = [air.molecules, partial(exponential, air.mie_scale_height_m), air.absorber]
    per_m = [air.rayleigh_scattering, air.mie_extinction, air.absorption_extinction]
    depth = slant_paths(straight, altitude_m, sine, densities) @ np.array(per_m)
    assert depth == pytest.approx(optical_depth_to_top(air, altitude_m, sine), rel=3e-4)


@pytest.mark.parametrize(
    ("altitude_m", "elevation_deg"), [(0.0, 0.0), (0.0, 1.0), (0.0, 30.0), (9000.0, -2.0)]
)
def test_a_bent_path_is_that_of_a_ray_followed_step_by_step(altitude_m, elevation_deg):
    """d(n t)/ds = grad n in the plane (Born and Wolf, section 3.2.1), on another planet."""
    density, step = partial(exponential, 1500.0), 20.0

    def moved(state, rates, length):
        return tuple(value + length * rate for value, rate in zip(state, rates, strict=True))

    def rates_of(state):
        x, y, turn = state
        radius = np.hypot(x, y)
        thin = SMALL.refractivity * float(SMALL.density(radius - SMALL.ground_radius_m))
        across = (y * np.cos(turn) - x * np.sin(turn)) / radius
        return np.cos(turn), np.sin(turn), -thin / 6000.0 * across / (1.0 + thin)

    state = 0.0, SMALL.ground_radius_m + altitude_m, np.radians(elevation_deg)
    path = 0.0
    while np.hypot(*state[:2]) < SMALL.ground_radius_m + SMALL.top_altitude_m:
        middle = moved(state, rates_of(state), 0.5 * step)
        path += step * float(density(np.hypot(*middle[:2]) - SMALL.ground_radius_m))
        state = moved(state, rates_of(middle), step)
    ours = slant_paths(SMALL, altitude_m, np.sin(np.radians(elevation_deg)), [density])
    assert ours[0] == pytest.approx(path, rel=2e-3)


@given(st.floats(0.0, 1e5), st.floats(-0.3, 1.0), st.floats(1e-9, 1e-4))
def test_paths_change_without_a_jump(altitude_m, sine, step):
    """Through the level and through the horizon, where the formula for the climb changes."""
    density = partial(exponential, 6000.0)
    one, other = slant_paths(SMALL, altitude_m, np.array([sine, sine - step]), [density])[:, 0]
    assert np.isfinite(one)
    assert one >= 0.0
    # The steepest slope is that at the level: two radii over the angle, some 20 % a degree.
    assert abs(other - one) <= 60.0 * step * (one + 1.0)


def test_a_ray_below_the_horizon_grazes_the_ground():
    density = partial(exponential, 6000.0)
    horizon = float(horizon_sine(SMALL, 4000.0))
    at, below = slant_paths(SMALL, 4000.0, [horizon, horizon - 0.1], [density])[:, 0]
    assert below == pytest.approx(at, rel=1e-6)


def test_from_space_only_rays_that_meet_the_air_pass_any():
    density, high = partial(exponential, 6000.0), 500_000.0
    horizon = np.arcsin(horizon_sine(SMALL, high))
    through, beside, up = slant_paths(
        SMALL, high, np.sin([horizon, 0.5 * horizon, 0.1]), [density]
    )[:, 0]
    assert through > 2.0 * 6000.0
    assert (beside, up) == (0.0, 0.0)


def test_the_horizon_dips_as_the_traced_one_does():
    """The tables of refraction come from rays through the standard atmosphere of ISO 2533."""
    for height_m in (100.0, 3000.0, 12_000.0):
        ours = -np.arcsin(horizon_sine(clear_air.STANDARD_AIR, height_m))
        assert ours == pytest.approx(dip_rad(height_m), rel=0.06)

"""The solver in ground fog: against Monte Carlo truth, and where the answer is known."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from bruneton_sky import Atmosphere, earth_spectral, single_scattering
from bruneton_sky.geometry import make_ray
from bruneton_sky.optical_path import optical_depth
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.solver import (
    SolverSizes,
    SourceField,
    ground_irradiance,
    multiple_scattering,
    single_scattering_fast,
    solve,
)
from bruneton_sky.solver_job import solve_air
from hypothesis import given, settings
from hypothesis import strategies as st
from long_parameters import mostly_long

TRUTH = np.load(Path(__file__).parents[2] / "data" / "fog_truth.npz")
AIR = earth_spectral((600.0, 450.0)).with_aerosol(0.1)
SMALL = SolverSizes(
    altitude=10, mu_s=16, direction_mu=16, direction_azimuth=8, degree=8, source_mu=16, steps=24
)


def solved(air: Atmosphere) -> SourceField:
    """As the module solves its air."""
    return solve_air(air)


@cache
def field_of(visibility_m: float) -> SourceField:
    return solved(AIR.with_fog(visibility_m, 100.0))


def look(
    field: SourceField, altitude_m: float, mu: np.ndarray, mu_s: float, nu: np.ndarray
) -> np.ndarray:
    """Radiance (n, C) of all orders, by the solver's bins throughout."""
    rayleigh, mie = single_scattering_fast(field, altitude_m, mu, mu_s, nu)
    cosine = nu[:, None]
    once = rayleigh * rayleigh_phase(cosine) + mie * mie_phase(field.atmosphere, cosine)
    return once + multiple_scattering(field, altitude_m, mu, mu_s, nu)


def rays(mu_s: float) -> tuple[np.ndarray, np.ndarray]:
    mu = np.array([1.0, 0.5, 0.1, 0.0, -0.1, -0.5, -1.0])
    return mu, mu * mu_s + 0.5 * np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2))


@pytest.mark.long
@pytest.mark.parametrize("visibility_m", [200.0, 1000.0])
@pytest.mark.parametrize("elevation_deg", [60.0, 20.0, 5.0])
@pytest.mark.parametrize("altitude_m", [2.0, 100.0, 800.0])
def test_radiance_is_that_of_monte_carlo(
    visibility_m: float, elevation_deg: float, altitude_m: float
) -> None:
    """Up, level and down, in the fog and above it: all light to 2 % in the mean, and noise."""
    chosen = TRUTH["visibility_m"] == visibility_m
    chosen &= TRUTH["sun_elevation_deg"] == elevation_deg
    chosen &= TRUTH["altitude_m"] == altitude_m
    mu_s = float(TRUTH["mu_s"][chosen][0])
    ours = look(field_of(visibility_m), altitude_m, TRUTH["mu"][chosen], mu_s, TRUTH["nu"][chosen])
    truth, noise = TRUTH["total"][chosen], TRUTH["error"][chosen]
    error = np.abs(ours / truth - 1.0)
    # The mean size of a normal error is 0.8 standard deviations.
    assert error.mean() < 0.02 + 0.8 * (noise / truth).mean()
    assert np.all(error < 0.05 + 3.0 * noise / truth)


@pytest.mark.parametrize("visibility_m", mostly_long([200.0, 1000.0], (1000.0).__eq__))
def test_irradiance_is_that_of_monte_carlo(visibility_m: float) -> None:
    """The sky's light on level ground under the fog: 2 % and noise."""
    row = (200.0, 1000.0).index(visibility_m)
    ours = ground_irradiance(field_of(visibility_m), np.sin(np.radians([60.0, 20.0, 5.0])))
    truth, noise = TRUTH["irradiance"][row], TRUTH["irradiance_error"][row]
    assert np.all(np.abs(ours - truth) < 0.02 * truth + 3.0 * noise)


@pytest.mark.parametrize("visibility_m", [200.0, 1000.0, 2000.0])
def test_black_wall_at_the_visibility(visibility_m: float) -> None:
    """Koschmieder: of a black wall so far away the contrast with the horizon beside it is 2 %.

    The wall's radiance is that of the air before it: the horizon's, less what comes from behind
    the wall and through the air between. The horizon is as bright at the wall as here.
    """
    air = earth_spectral((550.0,)).with_aerosol(0.1).with_fog(visibility_m, 100.0)
    field = solve(air, sizes=SMALL, all_orders=True)
    mu_s, level = 0.5, np.zeros(1)
    radius = air.ground_radius_m
    ray = make_ray(radius, 0.0, 0.0)
    rise = visibility_m**2 / (2.0 * radius)
    depth = optical_depth(air, ray, np.asarray(rise), np.sqrt(np.asarray(rise)))
    here = look(field, 0.0, level, mu_s, level)
    there = look(field, rise, level + visibility_m / radius, mu_s, level)
    wall = here - np.exp(-depth) * there
    assert (here - wall) / here == pytest.approx(0.02, rel=0.02)


@pytest.mark.long
def test_fog_fades_to_none() -> None:
    """As fog thins, or shrinks to nothing, the sky becomes that without fog: 1 % in the mean, 3 %
    at most, which is what fewer bins and nodes make of the same air without fog."""
    clear = solved(AIR)
    thinnest = replace(AIR, fog_extinction=1e-8, fog_scattering=1e-8)
    for thin, lowest in ((thinnest, -1.0), (AIR.with_fog(1000.0, 0.05), 0.0)):
        field = solved(thin)
        for mu_s, altitude_m in ((0.8, 2.0), (0.1, 2.0), (0.1, 3000.0)):
            mu, nu = rays(mu_s)
            none = look(clear, altitude_m, mu, mu_s, nu)
            # Of two metres of air looked down through, the least fog is the most.
            seen = (none > 1e-3 * none.max()) & (mu >= lowest)[:, None]
            error = np.abs(look(field, altitude_m, mu, mu_s, nu)[seen] / none[seen] - 1.0)
            assert error.mean() < 0.01
            assert error.max() < 0.03


def test_light_follows_visibility() -> None:
    """From 20 km to 2 km in steps of a tenth nothing jumps: a step changes no ray by more than
    it should, a tenth of the fog's extinction at most and 2 % of interpolation."""
    mu, nu = rays(0.4)
    seen = [
        look(solve(AIR.with_fog(v, 100.0), 8, sizes=SMALL, all_orders=True), 2.0, mu, 0.4, nu)
        for v in 20_000.0 * 0.9 ** np.arange(12)
    ]
    steps = np.abs(np.diff(np.log(seen), axis=0))
    assert steps.max() < 0.12
    assert np.abs(np.diff(np.log(seen), n=2, axis=0)).max() < 0.05


@given(
    st.floats(50.0, 20_000.0), st.floats(5.0, 1000.0), st.floats(0.0, 60_000.0),
    st.floats(-0.2, 1.0),
)  # fmt: skip
@settings(deadline=None, max_examples=15)
def test_radiance_is_finite_and_not_negative(
    visibility_m: float, height_m: float, altitude_m: float, mu_s: float
) -> None:
    """Finite and not negative, whatever the fog, the observer and the sun."""
    air = AIR.with_fog(visibility_m, height_m)
    field = solve(air, 6, sizes=SMALL, all_orders=True)
    mu, nu = rays(mu_s)
    light = look(field, altitude_m, mu, mu_s, nu)
    assert np.isfinite(light).all()
    assert (light >= 0.0).all()
    on_ground = ground_irradiance(field, [mu_s])
    assert np.isfinite(on_ground).all()
    assert (on_ground >= 0.0).all()
    exact = single_scattering(air, altitude_m, mu, mu_s, nu)
    assert np.isfinite(exact).all()

"""Solved skies against Monte Carlo with the same air: standard density, dust, another planet."""

import numpy as np
import pytest
from bruneton_sky import SolvedSky, single_scattering, solve
from bruneton_sky.presets import earth_spectral, earth_standard
from bruneton_sky.solver import solve as solve_field
from other_planet import LIGHT, OTHER_PLANET, RAYS

from vrut_lite.atmosphere.aerosols import type_optics
from vrut_lite.geometry.colour import SKYLIGHT_NM
from vrut_lite_lab.monte_carlo import monte_carlo_radiance, monte_carlo_stokes
from vrut_lite_lab.twilight_fit import air as twilight_air
from vrut_lite_lab.twilight_fit.spectra import rgb_of

pytestmark = pytest.mark.long


def cosine_to_sun(mu, mu_s, cos_azimuth):
    return mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * cos_azimuth


@pytest.mark.parametrize("elevation_deg", [30.0, 0.0, -6.0])
def test_all_orders_in_air_of_standard_density(elevation_deg):
    """Toward the sun, overhead and away from it: 1.2 % and the noise."""
    air, mu, mu_s = earth_standard(), np.array([0.2, 1.0, 0.3]), np.sin(np.radians(elevation_deg))
    nu = cosine_to_sun(mu, mu_s, np.array([1.0, 1.0, -1.0]))
    truth, _, _ = monte_carlo_stokes(air, 0.0, mu, mu_s, nu, paths=16_384)
    ours = SolvedSky(field=solve_field(air, all_orders=True)).radiance(0.0, mu, mu_s, nu)
    off = np.abs(ours / truth.total() - 1.0)
    assert (off < 0.012 + 3.5 * truth.total_error() / truth.total()).all()


@pytest.mark.parametrize("aerosol", ["continental-average", "desert"])
def test_a_sharp_forward_peak(aerosol):
    """By day, on the ground, with the same table, within noise and 1 %."""
    optics = type_optics(aerosol)
    air = earth_spectral(SKYLIGHT_NM).with_optics(optics, optics.optical_depth_550)
    mu = np.sin(np.radians([6.0, 20.0, 60.0, 6.0, 20.0, 60.0]))
    nu = cosine_to_sun(mu, 0.5, np.cos(np.radians([10.0, 10.0, 10.0, 150.0, 150.0, 150.0])))
    chance, _, _ = monte_carlo_stokes(air, 0.0, mu, 0.5, nu, paths=4096)
    off = np.abs(solve(air).radiance(0.0, mu, 0.5, nu) - chance.total())
    assert (off <= 3.0 * chance.total_error() + 0.01 * chance.total()).all()


@pytest.mark.parametrize("altitude_m", [5e3, 3e5])
def test_the_planet_under_dust_is_monte_carlos(altitude_m):
    """Air and ground together, within noise and 0.5 %: what delta-M takes for the ground's own
    light, not scattered, is to Monte Carlo the light of the air; each alone differs by 2 %."""
    optics = type_optics("desert")
    air = earth_spectral(SKYLIGHT_NM).with_optics(optics, optics.optical_depth_550)
    sky, mu_s = solve(air), np.sin(np.radians(60.0))
    mu, turn = np.array([-0.9, -0.5, -0.9, -0.5]), np.array([0.9, 0.9, -0.8, -0.8])
    nu = cosine_to_sun(mu, mu_s, turn)
    added, passed = sky.radiance_to_point(altitude_m, mu, mu_s, nu, 1e9)
    eye, ground = air.ground_radius_m + altitude_m, air.ground_radius_m
    way = -eye * mu - np.sqrt(ground**2 - eye**2 * (1.0 - mu**2))
    there = (eye * mu_s + way * nu) / ground
    sun, skylight = sky.irradiance(0.0, there)
    lit = sun * there[:, None] + skylight
    seen = added + passed * np.asarray(air.ground_albedo) / np.pi * lit
    chance, _, _ = monte_carlo_stokes(air, altitude_m, mu, mu_s, nu, paths=8192, ground_seen=True)
    off = np.abs(seen - chance.total())
    assert (off <= 3.0 * chance.total_error() + 0.005 * chance.total()).all()


def test_the_light_of_another_planet_is_traced_again():
    """With other random numbers and fewer paths: within four standard errors."""
    light = monte_carlo_radiance(OTHER_PLANET, *RAYS, paths=8192, seed=5)
    assert np.all(np.abs(light.total() - LIGHT) < 4.0 * light.total_error())


def test_the_blue_of_the_twilights_zenith_is_traced_again():
    """Fewer paths, within 2 % of the reference that tests/dynamic_skylight holds the table to."""
    mu_s, air = float(np.sin(np.radians(-5.0))), twilight_air.air(2.0)
    first = single_scattering(air, 0.0, 1.0, mu_s, mu_s, samples=48)
    light = monte_carlo_radiance(air, 0.0, 1.0, mu_s, mu_s, paths=16384, seed=7)
    traced = rgb_of(first + light.total(2)[0])
    assert traced[2] / traced[1] == pytest.approx(2.385, rel=0.02)

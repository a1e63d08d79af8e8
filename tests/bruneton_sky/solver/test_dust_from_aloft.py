"""Desert dust, seen down from the air and from space, against Monte Carlo with the same tables."""

import numpy as np
import pytest
from bruneton_sky import solve
from bruneton_sky.presets import earth_spectral

from vrut_lite.atmosphere.aerosols import type_optics
from vrut_lite.geometry.colour import SKYLIGHT_NM


@pytest.mark.long
@pytest.mark.parametrize("altitude_m", [5e3, 3e5])
def test_the_planet_under_dust_is_monte_carlos(altitude_m):
    """Air and ground together, within noise and 0.5 %: what delta-M takes for the ground's own
    light, not scattered, is to Monte Carlo the light of the air; each alone differs by 2 %."""
    from vrut_lite_lab.monte_carlo import monte_carlo_radiance

    optics = type_optics("desert")
    air = earth_spectral(SKYLIGHT_NM).with_optics(optics, optics.optical_depth_550)
    sky, mu_s = solve(air), np.sin(np.radians(60.0))
    mu, turn = np.array([-0.9, -0.5, -0.9, -0.5]), np.array([0.9, 0.9, -0.8, -0.8])
    nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * turn
    added, passed = sky.radiance_to_point(altitude_m, mu, mu_s, nu, 1e9)
    eye, ground = air.ground_radius_m + altitude_m, air.ground_radius_m
    way = -eye * mu - np.sqrt(ground**2 - eye**2 * (1.0 - mu**2))
    there = (eye * mu_s + way * nu) / ground
    sun, skylight = sky.irradiance(0.0, there)
    lit = sun * there[:, None] + skylight
    seen = added + passed * np.asarray(air.ground_albedo) / np.pi * lit
    chance = monte_carlo_radiance(air, altitude_m, mu, mu_s, nu, paths=8192, ground_seen=True)
    off = np.abs(seen - chance.total())
    assert (off <= 3.0 * chance.total_error() + 0.005 * chance.total()).all()

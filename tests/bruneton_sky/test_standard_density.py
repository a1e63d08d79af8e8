"""Air of the standard atmosphere's density: solver, rays in float64 and Monte Carlo agree."""

import numpy as np
import pytest
from bruneton_sky import SolvedSky, single_scattering
from bruneton_sky.presets import earth_at_night
from bruneton_sky.solver import solve

from vrut_lite_lab.monte_carlo import monte_carlo_radiance

# Views toward the sun, overhead and away from it.
MU, AZIMUTH = np.array([0.2, 1.0, 0.3]), np.array([0.0, 0.0, np.pi])


def views(elevation_deg):
    mu_s = np.sin(np.radians(elevation_deg))
    return mu_s, MU * mu_s + np.sqrt((1.0 - MU**2) * (1.0 - mu_s**2)) * np.cos(AZIMUTH)


@pytest.mark.parametrize("elevation_deg", [40.0, 3.0])
def test_light_scattered_once_is_the_classical_rules(elevation_deg):
    mu_s, nu = views(elevation_deg)
    rays = earth_at_night(), 0.0, MU, mu_s, nu
    ours = single_scattering(*rays)
    np.testing.assert_allclose(
        ours, single_scattering(*rays, rule="trapezoid", samples=(2000, 400)), rtol=4e-3
    )


@pytest.mark.long
@pytest.mark.parametrize("elevation_deg", [30.0, 0.0, -6.0])
def test_all_orders_are_monte_carlos(elevation_deg):
    air, (mu_s, nu) = earth_at_night(), views(elevation_deg)
    truth = monte_carlo_radiance(air, 0.0, MU, mu_s, nu, paths=16_384)
    ours = SolvedSky(field=solve(air, all_orders=True)).radiance(0.0, MU, mu_s, nu)
    off = np.abs(ours / truth.total() - 1.0)
    noise = truth.total_error() / truth.total()
    print(elevation_deg, "off", off.mean(), "noise", noise.mean())
    assert (off < 0.012 + 3.5 * noise).all()

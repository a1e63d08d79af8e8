"""Air of the standard atmosphere's density: the fast rule and the classical one agree."""

import numpy as np
import pytest
from bruneton_sky import single_scattering
from bruneton_sky.presets import earth_standard

# Views toward the sun, overhead and away from it.
MU, AZIMUTH = np.array([0.2, 1.0, 0.3]), np.array([0.0, 0.0, np.pi])


def views(elevation_deg):
    mu_s = np.sin(np.radians(elevation_deg))
    return mu_s, MU * mu_s + np.sqrt((1.0 - MU**2) * (1.0 - mu_s**2)) * np.cos(AZIMUTH)


@pytest.mark.parametrize("elevation_deg", [40.0, 3.0])
def test_light_scattered_once_is_the_classical_rules(elevation_deg):
    mu_s, nu = views(elevation_deg)
    rays = earth_standard(), 0.0, MU, mu_s, nu
    ours = single_scattering(*rays)
    np.testing.assert_allclose(
        ours, single_scattering(*rays, rule="trapezoid", samples=(2000, 400)), rtol=4e-3
    )

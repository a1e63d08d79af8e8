"""The compiled rule against its exact twin."""

import numpy as np
import pytest
from bruneton_sky import Atmosphere
from bruneton_sky.path_kernels import ERFCX
from bruneton_sky.published.single_scattering import scattered_without_phase
from bruneton_sky.single_scattering_kernels import fast_scattered_without_phase
from scipy.special import erfcx


def rays(mu_s: float) -> tuple[np.ndarray, np.ndarray]:
    """View and scattering cosines: the special directions and a spread of others."""
    rng = np.random.default_rng(5)
    special = [1.0, 0.0, -1.0, 1e-6, -1e-6, -0.02]
    mu = np.concatenate([special, rng.uniform(-1, 1, 60), rng.uniform(-0.1, 0.1, 60)])
    sines = np.sqrt((1 - mu**2) * (1 - mu_s**2))
    phi = rng.uniform(0, np.pi, mu.size)
    return mu, np.clip(mu * mu_s + sines * np.cos(phi), -1.0, 1.0)


@pytest.mark.parametrize("height_m", [0.0, 1.7, 5000.0, 59_999.0, 60_000.0])
@pytest.mark.parametrize("mu_s", [1.0, 0.3, 0.0, -0.01, -0.1, -0.2, -1.0])
def test_kernel_agrees_with_its_twin(
    other_planet: Atmosphere, height_m: float, mu_s: float
) -> None:
    """The kernel's erfcx errs by 1.3e-9; so many times more as the optical depth is deep.

    Level with the ground that is 20 in clear air and 100 at aerosol optical depth 0.9.
    """
    mu, nu = rays(mu_s)
    hazy = Atmosphere.earth().with_aerosol(0.9)
    for air, tolerance in ((Atmosphere.earth(), 5e-8), (other_planet, 5e-8), (hazy, 4e-7)):
        exact = scattered_without_phase(air, height_m, mu, mu_s, nu)
        fast = fast_scattered_without_phase(air, height_m, mu, mu_s, nu)
        for ours, truth in zip(fast, exact, strict=True):
            floor = 1e-12 * truth.max()
            assert np.all(np.abs(ours - truth) <= np.maximum(tolerance * np.abs(truth), floor))


def test_erfcx_polynomial() -> None:
    """Relative error 1.3e-9 from 0 to the largest argument of a steep ray and beyond."""
    x = np.concatenate([np.linspace(0, 10, 1001), np.geomspace(10, 1e4, 200)])
    t = (x - 4.0) / (x + 4.0)
    ours = np.polynomial.polynomial.polyval(t, ERFCX) / (1.0 + 2.0 * x)
    assert ours == pytest.approx(erfcx(x), rel=1.5e-9)

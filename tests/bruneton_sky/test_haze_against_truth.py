"""The module's own sky in haze against Monte Carlo: what it solves, and how its table looks."""

from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.sky_view import table_counts
from bruneton_sky.sky_view.rays import SkyViewRays
from bruneton_sky.solver import SourceField, ground_irradiance
from numpy.typing import NDArray
from scalar_air import scalar_field
from spectral_rows import total_radiance

TRUTH = np.load(Path(__file__).parents[1] / "data" / "haze_truth.npz")
TURBIDITIES, SUNS_DEG = (3.0, 10.0), (60.0, 10.0, 2.0)


@lru_cache
def field(turbidity: float) -> SourceField:
    """As the module solves it."""
    settings = BrunetonSkySettings(turbidity=turbidity, aerosol="one-lobe")
    return scalar_field(atmosphere_of(settings), settings.orders)


def compare(
    turbidity: float, elevation_deg: float, altitude_m: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Relative errors (rays, 4) of all light, and the truth's standard errors."""
    chosen = TRUTH["turbidity"] == turbidity
    chosen &= TRUTH["sun_elevation_deg"] == elevation_deg
    chosen &= TRUTH["altitude_m"] == altitude_m
    mu, nu, mu_s = (TRUTH[name][chosen] for name in ("mu", "nu", "mu_s"))
    # From 2 km the horizon lies at -0.025.
    rows = SkyViewRays(
        np.full(mu.size, altitude_m), mu, mu < -0.025, mu_s[:, None], nu[:, None], np.zeros(2)
    )
    counts = table_counts(field(turbidity).atmosphere, altitude_m, float(mu_s[0]))
    ours = total_radiance(field(turbidity), rows, counts)[:, 0]
    total = TRUTH["first"][chosen] + TRUTH["multiple"][chosen]
    return ours / total - 1.0, TRUTH["error"][chosen] / total


@pytest.mark.parametrize(
    ("turbidity", "elevation_deg", "mean", "largest"),
    [
        (3.0, 60.0, 2e-3, 5e-3),
        (3.0, 10.0, 3e-3, 1e-2),
        (3.0, 2.0, 5e-3, 2e-2),
        (10.0, 60.0, 8e-3, 4e-2),
        (10.0, 10.0, 1.2e-2, 5e-2),
        (10.0, 2.0, 1.2e-2, 5e-2),
    ],
)
@pytest.mark.parametrize("altitude_m", [0.0, 2000.0])
def test_sky_is_that_of_monte_carlo(
    turbidity: float, elevation_deg: float, mean: float, largest: float, altitude_m: float
) -> None:
    """From the ground and from above the haze, toward the sun and away, steep and level: all light
    of the module's four wavelengths, above what noise of the truth (0.1 to 1.5 %) adds."""
    error, noise = compare(turbidity, elevation_deg, altitude_m)
    # The mean size of a normal error is 0.8 standard deviations.
    assert np.abs(error).mean() < mean + 0.8 * noise.mean()
    assert np.all(np.abs(error) < largest + 3.0 * noise)


@pytest.mark.parametrize("turbidity", TURBIDITIES)
def test_light_on_the_ground_is_that_of_monte_carlo(turbidity: float) -> None:
    """The sky's light on level ground: 1 % and noise, in the thickest haze 2 %."""
    row = TURBIDITIES.index(turbidity)
    ours = ground_irradiance(field(turbidity), np.sin(np.radians(SUNS_DEG)))
    truth, noise = TRUTH["irradiance"][row], TRUTH["irradiance_error"][row]
    most = 0.01 if turbidity == 3.0 else 0.02
    assert np.all(np.abs(ours - truth) < most * truth + 3.0 * noise)

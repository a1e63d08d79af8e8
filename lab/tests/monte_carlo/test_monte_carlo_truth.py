"""The data file that fast solvers are judged by: what it says, another seed says too."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bruneton_sky import Atmosphere, single_scattering

from vrut_lite_lab.monte_carlo import monte_carlo_irradiance, monte_carlo_radiance

TRUTH = Path(__file__).parents[3] / "tests" / "data" / "bruneton_truth.npz"
RAYS = "altitude_m", "mu", "mu_s", "nu"


@pytest.fixture(scope="module")
def truth():
    with np.load(TRUTH) as file:
        return dict(file)


def air(factor):
    """Earth with ozone and so many times its aerosol."""
    earth = Atmosphere.earth()
    return replace(
        earth,
        mie_scattering=tuple(factor * s for s in earth.mie_scattering),
        mie_extinction=tuple(factor * e for e in earth.mie_extinction),
    )


@pytest.mark.long
def test_higher_orders_are_traced_again(truth):
    """Every 17th ray with other random numbers: the deviations are those of chance.

    Some 60 rays times 3 dependent wavelengths: rms 1.07 +- 0.1. Rays fainter than 1e-5 of the
    brightest are left out: the limb in the planet's shadow, where so few paths find no light.
    """
    bright = truth["multiple"].min(axis=1) > 1e-5 * truth["multiple"].max()
    deviations = []
    for factor in (1.0, 10.0):
        some = np.flatnonzero(bright & (truth["aerosol_factor"] == factor))[::17]
        rays = (truth[name][some] for name in RAYS)
        light = monte_carlo_radiance(air(factor), *rays, paths=2048, seed=777)
        error = np.hypot(light.total_error(2), truth["multiple_error"][some])
        deviations.append((light.total(2) - truth["multiple"][some]) / error)
    assert sum(map(len, deviations)) > 55
    assert np.sqrt(np.mean(np.concatenate(deviations) ** 2)) < 1.3


def test_first_order_is_exact_where_the_rays_enter(truth):
    """The file's own order 1 against another number of nodes, ozone's kinks allowed for."""
    for factor in (1.0, 10.0):
        some = np.flatnonzero(truth["aerosol_factor"] == factor)[::11]
        rays = (truth[name][some] for name in ("entry_altitude_m", "entry_mu", "entry_mu_s", "nu"))
        ours = single_scattering(air(factor), *rays, samples=96)
        largest = truth["first"][some].max(axis=0)
        np.testing.assert_allclose(ours, truth["first"][some], rtol=2e-3, atol=1e-9 * largest.max())


@pytest.mark.long
def test_irradiance_is_traced_again(truth):
    """All suns, clear air and haze, with other random numbers: 16 x 3 deviations of chance."""
    mu_s = np.cos(np.radians(truth["irradiance_sun_zenith_deg"]))
    deviations = []
    for i, factor in enumerate(truth["irradiance_aerosol_factor"]):
        light = monte_carlo_irradiance(air(factor), mu_s, paths=4096, seed=777)
        error = np.hypot(light.total_error(), truth["irradiance_total_error"][i])
        deviations.append((light.total() - truth["irradiance_total"][i]) / error)
    # 16 independent suns: 1.07 +- 0.19.
    assert np.sqrt(np.mean(np.square(deviations))) < 1.6
    assert np.abs(deviations).max() < 5


def test_orders_in_the_file_sum_to_the_whole(truth):
    """The orders sum to the whole; the notes name every array."""
    np.testing.assert_allclose(truth["orders"].sum(axis=1), truth["multiple"], rtol=1e-5)
    whole = truth["irradiance"].sum(axis=2)
    np.testing.assert_allclose(whole, truth["irradiance_total"], rtol=1e-5)
    assert all(name in str(truth["notes"]) for name in truth if name != "notes")

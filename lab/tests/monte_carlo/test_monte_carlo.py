"""The path tracer: another program's truth, exact limits, noise that is what it says.

Its kernels take 13 s to compile: `make test` holds the product to the truths that it once made.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bruneton_sky import Atmosphere, single_scattering

from vrut_lite_lab.monte_carlo import (
    BATCHES,
    enter_atmosphere,
    monte_carlo_irradiance,
    monte_carlo_leaving,
    monte_carlo_radiance,
    unscattered_share,
)

DATA = Path(__file__).parents[3] / "tests" / "data"
EARTH = Atmosphere.earth()


def scattering_cosine(mu, mu_s, azimuth):
    """Cosine between view and sun."""
    sines = np.sqrt((1 - np.square(mu)) * (1 - np.square(mu_s)))
    return np.clip(np.multiply(mu, mu_s) + sines * np.cos(azimuth), -1.0, 1.0)


def rms(deviations):
    return np.sqrt(np.mean(np.square(deviations)))


@pytest.fixture(scope="module")
def ground_truth():
    """15 directions for each sun of the file, and the tracer's estimates for them."""
    with np.load(DATA / "sky_truth_ground.npz") as file:
        data = dict(file)
    sun, view, azimuth = np.meshgrid(
        *(np.radians(data[axis]) for axis in ("sza", "vza", "raz")), indexing="ij"
    )
    some = np.s_[:, ::3, ::3]
    mu, mu_s = np.cos(view[some]).ravel(), np.cos(sun[some]).ravel()
    air = replace(
        Atmosphere.earth(ozone=False),
        solar_irradiance=(1.0,) * 3,
        rayleigh_scattering=(5.802e-6, 13.558e-6, 33.1e-6),
    )
    nu = scattering_cosine(mu, mu_s, azimuth[some].ravel())
    light = monte_carlo_radiance(air, 0.0, mu, mu_s, nu, paths=4096, max_order=8)
    return light, {name: data[name][some] for name in ("order1", "ms", "ms_err", "orders")}


@pytest.mark.long
def test_higher_orders_agree_with_another_program(ground_truth):
    """Orders 2 and up at the ground, sun at 0, 60, 87 deg: chi square of the joint errors.

    tests/data/sky_truth_ground.npz holds 400,000 paths of a tracer that shares nothing with
    this one. 45 independent directions times 3 dependent wavelengths, errors from 16 batches:
    the rms of the deviations is 1.07 +- 0.11, their mean at each sun 0 +- 0.28.
    """
    light, truth = ground_truth
    shape = truth["ms"].shape
    error = np.hypot(light.total_error(2).reshape(shape), truth["ms_err"])
    deviation = (light.total(2).reshape(shape) - truth["ms"]) / error
    assert rms(deviation) < 1.3
    assert np.abs(deviation.mean(axis=(1, 2))).max() < 0.84


@pytest.mark.long
def test_each_order_agrees_with_another_program(ground_truth):
    """The same for orders 2 to 5 one by one; so few paths find few of the higher ones.

    The file has no errors by order; in the sum they are a third of these, which makes the rms
    of the deviations 1.15 instead of 1.07, and heavier tails raise it with the order.
    """
    light, truth = ground_truth
    # (ray, wavelength, order): orders 2 to 5 stand at indices 2 to 5.
    theirs = truth["orders"].reshape(-1, 3, 9)[..., 2:6].swapaxes(1, 2)
    deviation = (light.per_order[:, 1:5] - theirs) / light.standard_error[:, 1:5]
    assert np.sqrt(np.mean(deviation**2, axis=(0, 2))).max() < 1.6


@pytest.mark.long
def test_first_order_is_the_exact_one(ground_truth):
    """The estimate of what is known exactly must err as its standard errors say: rms 1.07."""
    light, truth = ground_truth
    exact = truth["order1"].reshape(-1, 3)
    deviation = (light.per_order[:, 0] - exact) / light.standard_error[:, 0]
    assert rms(deviation) < 1.4


@pytest.mark.long
def test_first_order_from_everywhere_on_another_planet(other_planet):
    """From the ground, the air and space, down to a sun 7 degrees below the horizon."""
    altitude = np.array([0.0, 0.0, 20e3, 20e3, 90e3, 400e3, 400e3])
    mu = np.array([0.6, 0.02, -0.2, 0.3, -0.4, -0.9, -0.45])
    for mu_s in (0.7, 0.05, -0.12):
        nu = scattering_cosine(mu, mu_s, 0.8)
        light = monte_carlo_radiance(other_planet, altitude, mu, mu_s, nu, paths=4096)
        entry = enter_atmosphere(other_planet, altitude, mu, np.full_like(mu, mu_s), nu)
        exact = single_scattering(other_planet, *entry, nu, samples=64)
        deviation = light.per_order[:, 0] - exact
        # Four errors: the largest of some twenty independent numbers; and quadrature's own.
        assert (np.abs(deviation) <= 4 * light.standard_error[:, 0] + 1e-5 * exact).all()


@pytest.mark.long
@pytest.mark.parametrize("kind", ["earth", "haze", "small"])
def test_energy_is_conserved(kind):
    """Nothing absorbs, the ground is white: what leaves the planet is what entered, to 0.4 %.

    The whole must be 1 within four standard errors, which are themselves small enough to tell:
    a normalisation of the phase functions or of the distances would show.
    """
    air = replace(
        Atmosphere.earth(ozone=False), ground_albedo=(1.0,) * 3, mie_scattering=(4.44e-6,) * 3
    )
    if kind != "earth":
        thick = (2e-5, 5e-5, 1e-4)
        air = replace(air, mie_scattering=thick, mie_extinction=thick)
    if kind == "small":
        air = replace(air, ground_radius_m=3e5, mie_phase="henyey-greenstein", mie_g=-0.4)
    leaving = monte_carlo_leaving(air, paths=2**16, seed=1)
    error = leaving.total_error()[0]
    whole = leaving.total()[0] + unscattered_share(air)
    assert error[:2].max() < 4e-3
    assert (np.abs(whole - 1.0) < 4 * error).all()


@pytest.mark.long
def test_without_air_the_sky_is_black():
    """Without molecules and aerosol the sky is black; the ground is lit and seen exactly."""
    bare = replace(EARTH, rayleigh_scattering=0.0, mie_scattering=0.0, mie_extinction=0.0)
    bare = replace(bare, absorption_extinction=0.0)
    dark = monte_carlo_radiance(bare, 2e3, [0.5, -0.5], 0.6, 0.3, paths=64)
    np.testing.assert_array_equal(dark.batches, 0.0)
    seen = monte_carlo_radiance(bare, 2e3, -1.0, 0.6, -0.6, paths=64, ground_seen=True)
    lambertian = 0.1 / np.pi * 0.6 * np.array(EARTH.solar_irradiance)
    np.testing.assert_allclose(seen.total()[0], lambertian, rtol=1e-12)


@pytest.mark.long
def test_black_ground_and_no_aerosol_are_limits():
    """Without aerosol the light is the limit of thin aerosol; black ground adds none."""
    none = replace(EARTH, mie_scattering=0.0, mie_extinction=0.0, ground_albedo=0.0)
    faint = replace(none, mie_scattering=1e-16, mie_extinction=1e-16)
    rays = 1e3, [0.5, -0.3], 0.6, 0.2
    a, b = (monte_carlo_radiance(air, *rays, paths=256) for air in (none, faint))
    np.testing.assert_allclose(a.batches, b.batches, rtol=1e-6)
    seen = monte_carlo_radiance(none, *rays, paths=256, ground_seen=True)
    np.testing.assert_array_equal(a.batches, seen.batches)


@pytest.mark.long
def test_ozone_only_darkens():
    """It absorbs and scatters nothing; at 550 nm and a low sun it takes a tenth or more."""
    mu, mu_s = np.array([0.05, 0.3, 0.9, 0.3]), np.array([0.05, 0.0, -0.03, 0.7])
    nu = scattering_cosine(mu, mu_s, 1.0)
    clear = Atmosphere.earth(ozone=False)
    with_it, without = (
        monte_carlo_radiance(air, 0.0, mu, mu_s, nu, paths=4096) for air in (EARTH, clear)
    )
    ratio = with_it.total(2) / without.total(2)
    error = np.hypot(
        with_it.total_error(2) / with_it.total(2), without.total_error(2) / without.total(2)
    )
    assert (ratio < 1.0 + 3 * error).all()
    assert (ratio[:3, 1] < 0.9).all()


@pytest.mark.long
@pytest.mark.parametrize("sun_zenith_deg", [90.0, 93.0, 96.0])
def test_noise_in_twilight_falls_with_the_root_of_the_paths(sun_zenith_deg):
    """Eight times the paths leave the error over the square root of 8: 0.35.

    Each error is itself uncertain by 18 %, and wavelengths share it: the mean of the six rays'
    logarithms is uncertain by 0.1, and heavy tails add to it.
    """
    mu = np.array([0.05, 0.05, 0.3, 0.3, 0.9, 0.9])
    mu_s = float(np.cos(np.radians(sun_zenith_deg)))
    nu = scattering_cosine(mu, mu_s, np.tile([0.3, 2.0], 3))
    few, many = (
        monte_carlo_radiance(EARTH, 0.0, mu, mu_s, nu, paths=paths) for paths in (1024, 8192)
    )
    assert np.isfinite(many.batches).all()
    assert (many.total(2) > 0).all()
    ratio = many.total_error(2) / few.total_error(2)
    assert 0.25 < np.exp(np.log(ratio).mean()) < 0.5
    # And both sizes mean the same light.
    error = np.hypot(many.total_error(2), few.total_error(2))
    assert rms((many.total(2) - few.total(2)) / error) < 1.6


@pytest.mark.long
def test_equal_seeds_make_equal_light(other_planet):
    """A ray's estimate depends on the seed and its index alone, not on the other rays."""
    rays = 0.0, [0.4, 0.1], -0.05, 0.3
    one, same, other = (
        monte_carlo_radiance(other_planet, *rays, paths=64, seed=s).batches for s in (1, 1, 2)
    )
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)
    alone = monte_carlo_radiance(other_planet, 0.0, 0.4, -0.05, 0.3, paths=64, seed=1)
    np.testing.assert_array_equal(one[:, :1], alone.batches)


@pytest.mark.long
def test_last_order_holds_all_higher_ones(other_planet):
    """How many orders are told apart does not change the paths, only which order they count for."""
    rays = other_planet, 1e3, 0.2, 0.5, 0.1
    ten = monte_carlo_radiance(*rays, paths=256)
    three = monte_carlo_radiance(*rays, paths=256, max_order=3)
    np.testing.assert_array_equal(ten.per_order[:, :2], three.per_order[:, :2])
    np.testing.assert_allclose(ten.total(3), three.per_order[:, 2], rtol=1e-12)


@pytest.mark.long
def test_observer_in_space_sees_what_one_at_the_top_sees(other_planet):
    """An observer outside is one at the top, further back on the same ray."""
    air, outside = other_planet, 250e3
    mu = np.array([-1.0, -0.7, -0.45, -0.2])
    mu_s, nu = np.full(4, 0.3), scattering_cosine(mu, 0.3, 0.7)
    altitude, mu_top, mu_s_top = enter_atmosphere(air, np.full(4, outside), mu, mu_s, nu)
    assert np.isnan(altitude[3])
    far = monte_carlo_radiance(air, outside, mu, mu_s, nu, paths=256, ground_seen=True)
    np.testing.assert_array_equal(far.batches[:, 3], 0.0)
    ends = altitude[:3], mu_top[:3], mu_s_top[:3], nu[:3]
    near = monte_carlo_radiance(air, *ends, paths=256, ground_seen=True)
    np.testing.assert_allclose(far.batches[:, :3], near.batches, rtol=1e-6)


@pytest.mark.long
def test_irradiance_is_the_integral_of_radiance(other_planet):
    """Gauss-Legendre over the hemisphere, 6 x 6 directions: both estimates within their errors.

    The quadrature's own error (2e-3, allowed for) is measured on the exact first order.
    """
    mu_s = 0.6
    x, weight = np.polynomial.legendre.leggauss(6)
    # Squared: the radiance is steep at the horizon.
    view, azimuth = np.meshgrid((0.5 * (x + 1)) ** 2, 0.5 * np.pi * (x + 1), indexing="ij")
    area = np.outer(weight * 0.5 * (x + 1), weight * np.pi)
    nu = scattering_cosine(view, mu_s, azimuth)
    light = monte_carlo_radiance(
        other_planet, 0.0, view.ravel(), mu_s, nu.ravel(), paths=512, max_order=3
    )
    integral = np.einsum("i,bikc->bkc", (area * view).ravel(), light.batches)
    direct = monte_carlo_irradiance(other_planet, mu_s, paths=8192, max_order=3)
    error = np.hypot(integral.std(axis=0, ddof=1) / np.sqrt(BATCHES), direct.standard_error[0])
    deviation = integral.mean(axis=0) - direct.per_order[0]
    assert (np.abs(deviation) < 4 * error + 2e-3 * direct.per_order[0]).all()


@pytest.mark.parametrize(
    ("rays", "name"),
    [
        ((-1.0, 0.5, 0.5, 0.5), "altitude_m"),
        ((0.0, 1.5, 0.5, 0.5), "mu"),
        ((0.0, 0.5, np.nan, 0.5), "mu_s"),
        ((0.0, 0.5, 0.5, -2.0), "nu"),
    ],
)
def test_impossible_rays_are_refused_by_name(rays, name):
    """The refusal names the argument."""
    with pytest.raises(ValueError, match=f"^{name} must"):
        monte_carlo_radiance(EARTH, *rays)

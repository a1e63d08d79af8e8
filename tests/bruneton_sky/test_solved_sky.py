"""`solve`: the accurate sky in Python, against Monte Carlo, analytic limits and itself."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from bruneton_sky import Atmosphere, earth_spectral, single_scattering, solve
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solved_sky import SolvedSky
from hypothesis import example, given
from hypothesis import strategies as st
from long_parameters import mostly_long
from numpy.typing import NDArray
from other_planet import LIGHT, RAYS
from scalar_air import scalar_sky

from vrut_lite.geometry.cube_map import texel_directions

DATA = Path(__file__).parents[1] / "data"
TRUTH = np.load(DATA / "bruneton_truth.npz")
HAZE = np.load(DATA / "haze_truth.npz")
FOG = np.load(DATA / "fog_truth.npz")
EARTH = Atmosphere.earth()
Errors = tuple[NDArray[np.float64], NDArray[np.float64]]


@lru_cache
def sky(aerosol: float = 1.0) -> SolvedSky:
    """Earth's sky with so many times its aerosol."""
    scattering, extinction = (
        tuple(np.multiply(values, aerosol))
        for values in (EARTH.mie_scattering, EARTH.mie_extinction)
    )
    return scalar_sky(replace(EARTH, mie_scattering=scattering, mie_extinction=extinction))


@lru_cache
def hazy_sky(turbidity: float) -> SolvedSky:
    """The sky of the module's own air."""
    return scalar_sky(atmosphere_of(BrunetonSkySettings(turbidity=turbidity, aerosol="one-lobe")))


def errors(
    solved: SolvedSky, rays: list[NDArray[np.float64]], total: NDArray[np.float64], noise: NDArray
) -> Errors:
    """Errors (n, C) of `radiance`, and standard errors of the truth, relative to the larger of the
    truth and a thousandth of the brightest."""
    scale = np.maximum(total, 1e-3 * total.max())
    return (solved.radiance(*rays) - total) / scale, noise / scale


def against_truth(aerosol: float, zenith_deg: float) -> Errors:
    """All rays of the clear truth under one sun, from the ground to 300 km."""
    chosen = (TRUTH["aerosol_factor"] == aerosol) & (TRUTH["sun_zenith_deg"] == zenith_deg)
    rays = [TRUTH[name][chosen] for name in ("altitude_m", "mu", "mu_s", "nu")]
    total = TRUTH["first"][chosen] + TRUTH["multiple"][chosen]
    parts = []
    for altitude_m in np.unique(rays[0]):
        here = rays[0] == altitude_m
        own = [part[here] for part in rays]
        noise = TRUTH["multiple_error"][chosen][here]
        parts.append(errors(sky(aerosol), own, total[here], noise))
    error, noise = (np.concatenate(part) for part in zip(*parts, strict=True))
    return error, noise


@pytest.mark.parametrize(
    ("aerosol", "zenith_deg", "most"),
    [
        *((1.0, zenith, 2e-3) for zenith in (0.0, 30.0, 60.0, 80.0, 87.0)),
        (1.0, 90.0, 0.015), (1.0, 93.0, 0.025), (1.0, 96.0, 0.03),
        (10.0, 30.0, 4e-3), (10.0, 80.0, 8e-3), (10.0, 87.0, 0.012),
    ],
)  # fmt: skip
def test_radiance_is_that_of_monte_carlo(aerosol: float, zenith_deg: float, most: float) -> None:
    """Every ray from the ground to 300 km: by day in clear air within 0.2 % and three standard
    errors of the truth, and the rms error is that of the truth's noise but for 0.1 %."""
    error, noise = against_truth(aerosol, zenith_deg)
    assert np.all(np.abs(error) < most + 3.0 * noise)
    if most == 2e-3:
        assert np.sqrt((error**2).mean()) < 1e-3 + np.sqrt((noise**2).mean())


@pytest.mark.parametrize(
    ("turbidity", "elevation_deg", "most"),
    [
        (3.0, 60.0, 5e-3),
        (3.0, 10.0, 5e-3),
        (3.0, 2.0, 0.015),
        (10.0, 60.0, 0.02),
        (10.0, 10.0, 0.035),
    ],
)
def test_radiance_in_haze_is_that_of_monte_carlo(
    turbidity: float, elevation_deg: float, most: float
) -> None:
    """The module's own air at four wavelengths, from the ground and from 2 km."""
    chosen = (HAZE["turbidity"] == turbidity) & (HAZE["sun_elevation_deg"] == elevation_deg)
    rays = [HAZE[name][chosen] for name in ("altitude_m", "mu", "mu_s", "nu")]
    total = HAZE["first"][chosen] + HAZE["multiple"][chosen]
    error, noise = errors(hazy_sky(turbidity), rays, total, HAZE["error"][chosen])
    assert np.all(np.abs(error) < most + 3.0 * noise)


@pytest.mark.long
def test_radiance_in_fog_is_that_of_monte_carlo() -> None:
    """Visibility 200 m, in the fog and above it: 6 % and three standard errors, 3 % rms. A slowly
    sinking ray, black at its end, has all the light that it has half-way."""
    foggy = scalar_sky(earth_spectral((600.0, 450.0)).with_aerosol(0.1).with_fog(200.0, 100.0))
    chosen = FOG["visibility_m"] == 200.0
    rays = [FOG[name][chosen] for name in ("altitude_m", "mu", "mu_s", "nu")]
    error, noise = errors(foggy, rays, FOG["total"][chosen], FOG["error"][chosen])
    assert np.all(np.abs(error) < 0.06 + 3.0 * noise)
    assert np.sqrt((error**2).mean()) < 0.03
    view = (25.0, -0.0029, 0.5, 0.3)
    half_way, passed = foggy.radiance_to_point(*view, 4000.0)
    assert np.all(passed < 1e-12)
    assert half_way == pytest.approx(foggy.radiance(*view), rel=1e-2)


@pytest.mark.parametrize("aerosol", [1.0, 10.0])
def test_sky_irradiance_is_that_of_monte_carlo(aerosol: float) -> None:
    """It is within 0.4 % and three standard errors of the truth by day, within 2 % to 6 degrees of
    twilight."""
    row = list(TRUTH["irradiance_aerosol_factor"]).index(aerosol)
    zenith_deg = TRUTH["irradiance_sun_zenith_deg"]
    _, ours = sky(aerosol).irradiance(0.0, np.cos(np.radians(zenith_deg)))
    truth, noise = TRUTH["irradiance_total"][row], TRUTH["irradiance_total_error"][row]
    allowed = np.where(zenith_deg <= 90.0, 4e-3, 2e-2)[:, None] * truth
    assert np.all(np.abs(ours - truth) < allowed + 3.0 * noise)


def test_another_planets_sky_is_that_of_monte_carlo(other_planet: Atmosphere) -> None:
    """A small hazy planet at four wavelengths, from its ground, its air and space: 1 %, with three
    standard errors of at most 0.12 %."""
    ours = scalar_sky(other_planet).radiance(*RAYS)
    np.testing.assert_allclose(ours, LIGHT, rtol=1.4e-2)


def test_transparent_air_gives_nothing_and_takes_nothing(other_planet: Atmosphere) -> None:
    """Without matter the sky is black and all sunlight arrives."""
    none = (0.0,) * 4
    clear = solve(
        replace(
            other_planet, rayleigh_scattering=none, mie_scattering=none, mie_extinction=none,
            absorption_extinction=none,
        )
    )  # fmt: skip
    altitude_m, mu = np.array([0.0, 1e4, 1e6])[:, None], np.linspace(-1.0, 1.0, 9)
    light, transmittance = clear.radiance_to_point(altitude_m, mu, 0.3, 0.3 * mu, 1e7)
    assert not light.any()
    assert np.all(transmittance == 1.0)
    sun, skylight = clear.irradiance(altitude_m, 0.5)
    assert sun == pytest.approx(np.broadcast_to(other_planet.solar_irradiance, sun.shape))
    assert not skylight.any()


def test_thin_air_scatters_once(other_planet: Atmosphere) -> None:
    """Over black ground a ten thousandth of the air gives the light of `single_scattering`."""
    thin = replace(
        other_planet,
        **{
            name: tuple(1e-4 * np.asarray(getattr(other_planet, name)))
            for name in ("rayleigh_scattering", "mie_scattering", "mie_extinction")
        },
        absorption_extinction=0.0,
        ground_albedo=0.0,
    )
    altitude_m, mu_s = np.array([0.0, 3000.0, 90_000.0])[:, None], 0.4
    mu = np.array([-0.9, -0.3, 0.02, 0.5, 1.0])
    nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * 0.3
    once = single_scattering(thin, altitude_m, mu, mu_s, nu, samples=32)
    assert solve(thin).radiance(altitude_m, mu, mu_s, nu) == pytest.approx(once, rel=1e-3)


def test_rays_can_be_cut_and_joined() -> None:
    """The light to a point, and beyond it what the point sees, dimmed, is that of the whole ray;
    to the end of a ray it is `radiance`, and a distance of 0 has no light."""
    altitude_m, mu_s, planet_m = 2000.0, 0.3, EARTH.ground_radius_m
    mu = np.array([0.8, 0.1, 0.0, -0.02, -0.3])
    nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * 0.5
    whole = sky().radiance(altitude_m, mu, mu_s, nu)
    assert np.array_equal(sky().radiance_to_point(altitude_m, mu, mu_s, nu, 1e9)[0], whole)
    distance_m = np.array([10.0, 1e3, 5e3])[:, None]
    radius, there = planet_m + altitude_m, 0.0
    there = np.sqrt(radius**2 + distance_m**2 + 2.0 * radius * distance_m * mu)
    near, passed = sky().radiance_to_point(altitude_m, mu, mu_s, nu, distance_m)
    beyond = sky().radiance(
        there - planet_m, (radius * mu + distance_m) / there,
        (radius * mu_s + distance_m * nu) / there, nu,
    )  # fmt: skip
    assert near + passed * beyond == pytest.approx(np.broadcast_to(whole, near.shape), rel=2e-3)
    light, transmittance = sky().radiance_to_point(altitude_m, mu, mu_s, nu, 0.0)
    assert light == pytest.approx(0.0, abs=1e-12)
    assert transmittance == pytest.approx(1.0, abs=1e-12)


def test_the_sun_behind_the_air() -> None:
    """Its irradiance is the solar spectrum times the transmittance towards it; on the horizon only
    the upper, less dimmed half of the disc shows; below there is none."""
    altitude_m, mu_s = np.array([0.0, 5000.0, 4e5])[:, None], np.array([1.0, 0.5, 0.1])
    sun, _ = sky().irradiance(altitude_m, mu_s)
    _, passed = sky().radiance_to_point(altitude_m, mu_s, mu_s, 1.0, 1e9)
    assert sun == pytest.approx(np.asarray(EARTH.solar_irradiance) * passed, rel=1e-3)
    set_sun, half = (sky().irradiance(0.0, mu)[0] for mu in (-0.01, 0.0))
    assert not set_sun.any()
    _, level = sky().radiance_to_point(0.0, 0.0, 0.0, 1.0, 1e9)
    share = half / (np.asarray(EARTH.solar_irradiance) * level)
    assert np.all((share > 0.5) & (share < 1.0))


def test_irradiance_is_the_integral_of_radiance() -> None:
    """On the ground, in twilight too, in the air, and from both sides of the air's top."""
    x, w = np.polynomial.legendre.leggauss(32)
    mu, weight = (0.5 * (x + 1.0)) ** 2, 0.5 * w * (x + 1.0)
    turn = (np.arange(24) + 0.5) * np.pi / 24
    places = (0.0, 0.6), (0.0, -0.07), (5000.0, -0.1), (5000.0, 0.2), (59_000.0, 0.5)
    for altitude_m, mu_s in (*places, (61_000.0, 0.5)):
        nu = (mu * mu_s)[:, None] + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2))[:, None] * np.cos(turn)
        light = sky().radiance(altitude_m, mu[:, None], mu_s, nu)
        summed = (light.mean(axis=1) * (weight * mu)[:, None]).sum(axis=0) * 2.0 * np.pi
        assert sky().irradiance(altitude_m, mu_s)[1] == pytest.approx(summed, rel=3e-3, abs=1e-9)


@pytest.mark.parametrize("altitude_m", [0.0, 3000.0, 250_000.0])
def test_cube_map_is_that_of_single_rays(altitude_m: float) -> None:
    """They agree by day to 0.3 % in the mean, 1 % for 99 % of texels; below the horizon ground is
    lit by sun and sky, bare for who stands on it, else behind the air."""
    sun = np.array([0.0, 0.6, -0.8])
    cube = sky().cube_map(24, 3.0 * sun, altitude_m)
    assert cube.shape == (6, 24, 24, 3)
    assert cube.dtype == np.float32
    views = texel_directions(24).astype(float)
    mu, horizon = views[..., 1], float(horizon_mu(EARTH.ground_radius_m, altitude_m))
    # The limb from space is narrower than a texel, and the horizon falls within one.
    below, above = mu < horizon - 0.05, mu > (horizon + 0.01 if altitude_m < 1e5 else 0.0)
    rays = (altitude_m, mu, sun[1], np.clip(views @ sun, -1.0, 1.0))
    expected = sky().radiance_rgb(*rays)
    assert _mean_and_most(cube, expected, above) < (3e-3, 1e-2)
    # Straight down, where the sun stands as here; colours of sunlight and skylight differ.
    down = np.unravel_index(np.argmin(mu), mu.shape)
    disc, skylight = sky().irradiance(0.0, sun[1])
    light, passed = sky().radiance_to_point(altitude_m, -1.0, sun[1], -sun[1], 1e9)
    lit = _rgb(passed * disc * sun[1], 0.0) + _rgb(passed * skylight, 3.0)
    assert cube[down] == pytest.approx(_rgb(light, 3.0) + 0.1 / np.pi * lit, rel=1e-2)
    assert np.all(cube[below] > expected[below])


def _mean_and_most(
    cube: NDArray[np.float32], expected: NDArray[np.float64], chosen: NDArray[np.bool_]
) -> tuple[float, float]:
    """Mean and 99 % quantile of the error; of a sky that is black, the brightest texel."""
    error = np.abs(cube[chosen] - expected[chosen])
    scale = np.maximum(expected[chosen], 1e-3 * expected.max())
    return float((error / scale).mean()), float(np.quantile(error / scale, 0.99))


def _rgb(spectral: NDArray[np.float64], exponent: float) -> NDArray[np.float64]:
    from vrut_lite.geometry.colour import rgb_from_spectrum

    return rgb_from_spectrum(spectral, EARTH.wavelength_nm, exponent)


COSINE = st.floats(-1.0, 1.0) | st.sampled_from([-1.0, -1e-9, 0.0, 1e-9, 1.0])
ALTITUDE_M = st.floats(0.0, 1e6) | st.sampled_from([0.0, 60_000.0, 60_000.001])


@given(ALTITUDE_M, COSINE, COSINE, COSINE, st.floats(0.0, 3e6))
@example(60_000.0, 1.0, 1.0, 1.0, 1.0)
@example(0.0, -1.0, 0.5, -0.5, 1.0)
def test_answers_are_finite_and_not_negative(
    altitude_m: float, mu: float, mu_s: float, cos_azimuth: float, distance_m: float
) -> None:
    """From anywhere to 1000 km up, to anywhere, under any sun; farther points have no less light
    before them and no more transmittance."""
    nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * cos_azimuth
    nu = float(np.clip(nu, -1.0, 1.0))
    ways = np.array([0.0, 0.5, 1.0, 2.0]) * distance_m
    light, passed = sky().radiance_to_point(altitude_m, mu, mu_s, nu, ways)
    whole = sky().radiance(altitude_m, mu, mu_s, nu)
    irradiance = np.stack(sky().irradiance(altitude_m, mu_s))
    for values in (light, passed, whole, irradiance):
        assert np.all(np.isfinite(values) & (values >= 0.0))
    assert np.all(passed <= 1.0)
    assert np.all(np.diff(passed, axis=0) <= 1e-12)
    assert np.all(light <= whole * (1.0 + 0.02) + 1e-5)


@pytest.mark.parametrize("altitude_m", [2.0, 10_000.0, 400_000.0])
def test_no_jump_at_the_horizon(altitude_m: float) -> None:
    """As far as the horizon, rays just above and below it pass the same air."""
    horizon = float(horizon_mu(EARTH.ground_radius_m, altitude_m))
    mu = horizon + np.array([-1e-9, 1e-9])
    reach_m = 0.99 * np.sqrt(altitude_m * (2.0 * EARTH.ground_radius_m + altitude_m))
    light, passed = sky().radiance_to_point(altitude_m, mu, 0.4, 0.4 * mu, reach_m)
    assert light[0] == pytest.approx(light[1], rel=1e-3)
    assert passed[0] == pytest.approx(passed[1], rel=1e-3)


def test_the_top_of_the_atmosphere_is_no_edge() -> None:
    """An observer a millimetre above it sees what one a millimetre below does."""
    mu = np.array([-0.9, -0.2, -0.1])
    below, above = (sky().radiance(60_000.0 + rise, mu, 0.5, 0.5 * mu) for rise in (-1e-3, 1e-3))
    assert above == pytest.approx(below, rel=1e-4)
    up = np.array([0.0, 0.5, 1.0])
    assert not sky().radiance(60_001.0, up, 0.5, 0.5 * up).any()


@pytest.mark.parametrize("count", mostly_long([2, 5], (5).__eq__))
def test_wavelengths_do_not_mix(count: int) -> None:
    """Any number of them: each has the light that it has alone."""
    nm = tuple(np.linspace(450.0, 650.0, count))
    every = solve(earth_spectral(nm)).radiance(0.0, [0.2, 0.9], 0.5, 0.4)
    assert every.shape == (2, count)
    alone = solve(earth_spectral(nm[-1:])).radiance(0.0, [0.2, 0.9], 0.5, 0.4)
    # Orders of scattering are added until all wavelengths are well known.
    assert every[:, -1:] == pytest.approx(alone, rel=2e-3)


def test_arguments_broadcast_and_empty_ones_stay_empty() -> None:
    """Shapes follow numpy; no batch of rays changes another's result."""
    mu, mu_s = np.linspace(0.1, 1.0, 40)[:, None], np.linspace(-0.1, 0.9, 50)
    light = sky().radiance(np.array(500.0), mu, mu_s, mu * mu_s)
    assert light.shape == (40, 50, 3)
    assert light[17, 31] == pytest.approx(
        sky().radiance(500.0, mu[17, 0], mu_s[31], mu[17, 0] * mu_s[31]), rel=1e-12
    )
    assert sky().radiance([], 0.5, 0.5, 0.5).shape == (0, 3)
    assert [part.shape for part in sky().irradiance([], 0.5)] == [(0, 3), (0, 3)]


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda s: s.radiance(-1.0, 0.5, 0.5, 0.5), "altitude_m must lie between 0 and .* not -1"),
        (lambda s: s.radiance(np.nan, 0.5, 0.5, 0.5), "altitude_m must lie .* not nan"),
        (lambda s: s.radiance(0.0, 1.1, 0.5, 0.5), r"mu must lie between -1 and 1, not 1\.1"),
        (lambda s: s.radiance_rgb(0.0, 0.5, -1.1, 0.5), "mu_s must lie between"),
        (lambda s: s.radiance(0.0, 0.5, 0.5, "up"), "nu must be a number or an array of them"),
        (
            lambda s: s.radiance(0.0, [0.5] * 2, [0.5] * 3, 0.5),
            r"do not broadcast: altitude_m \(\), mu \(2,\), mu_s \(3,\), nu \(\)$",
        ),
        (lambda s: s.radiance(0.0, 1.0, 1.0, -1.0), "nu must lie .* not -1 at mu 1 and mu_s 1"),
        (lambda s: s.radiance(0.0, 0.5, [0.5, 0.9], 0.0), "nu must lie .* not 0 at mu .* mu_s 0.9"),
        (lambda s: s.radiance_to_point(0.0, 1, 1, 1, -1.0), "distance_m must lie .* m, not -1"),
        (lambda s: s.irradiance(0.0, 2.0), "mu_s must lie between -1 and 1, not 2"),
        (lambda s: s.irradiance(True, 0.5), "altitude_m must be a number"),
        (lambda s: s.cube_map(0), "size must lie between 1 and 8192, not 0"),
        (lambda s: s.cube_map(8, (0.0, 0.0, 0.0)), r"sun_direction must be one vector \(3,\)"),
        (lambda s: s.cube_map(8, (0.0, 1.0)), "sun_direction must be finite numbers of shape"),
        (lambda s: s.cube_map(8, altitude_m=-3.0), "altitude_m must lie between 0 and"),
        (lambda _: solve(3), "atmosphere must be of the class Atmosphere, not 3"),  # type: ignore[arg-type]
    ],
)  # fmt: skip
def test_bad_arguments_are_refused(call, sentence: str) -> None:  # type: ignore[no-untyped-def]
    """The sentence says name, value and range."""
    with pytest.raises(ValueError, match=sentence):
        call(sky())


def test_colour_of_too_few_wavelengths_is_refused() -> None:
    """Radiance has two wavelengths, colour has not."""
    two = solve(earth_spectral((500.0, 600.0)))
    assert two.radiance(0.0, 0.5, 0.5, 0.5).shape == (2,)
    with pytest.raises(ValueError, match="colour needs 3 wavelengths"):
        two.radiance_rgb(0.0, 0.5, 0.5, 0.5)

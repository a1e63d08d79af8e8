"""Aerosol of the stratosphere in Bruneton's sky: a tent of droplets about 20 km."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from bruneton_sky import Atmosphere, SolvedSky, precompute, single_scattering, solve
from bruneton_sky.optical_path import optical_depth_to_top
from bruneton_sky.phase import molecules_phase, particles_polarisation
from bruneton_sky.published.single_scattering import scattered_without_phase
from bruneton_sky.settings import (
    BrunetonSkySettings,
    atmosphere_at,
    atmosphere_of,
    spectral_atmosphere_of,
)
from bruneton_sky.single_scattering_kernels import fast_by_name, fast_scattered_without_phase
from bruneton_sky.sky_view import limb_counts, table_counts
from bruneton_sky.sky_view.rays import table_rows
from bruneton_sky.solver import SolverSizes, multiple_scattering
from bruneton_sky.solver import solve as solve_field
from bruneton_sky.solver.bin_kernels import bins_of_ray
from bruneton_sky.solver.delta_m import kept_coefficients
from bruneton_sky.solver.grid import SunGrid
from bruneton_sky.solver.particles import kinds_of, shares_above, shares_at
from bruneton_sky.solver.wavelength_groups import groups_of_air
from bruneton_sky.sun_light import haze_layers, sun_irradiance
from other_planet import OTHER_PLANET
from spectral_rows import total_radiance

from vrut_lite.atmosphere.aerosols.stratosphere import stratosphere
from vrut_lite.atmosphere.haze_layer import HAZE_NM
from vrut_lite.atmosphere.sunlight import slant_depth
from vrut_lite.geometry.colour import SKYLIGHT_NM, luminance, rgb_from_spectrum
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.haze import SetHaze

TROPOSPHERE_DEPTH = 0.195


def hazy(depth: float) -> SetHaze:
    """The default haze with another stratosphere."""
    return SetHaze(optical_depth_550=TROPOSPHERE_DEPTH + depth, stratosphere_depth_550=depth)


def air_of(depth: float) -> Atmosphere:
    return atmosphere_of(BrunetonSkySettings(), 0.0, hazy(depth))


@lru_cache
def sky_of(depth: float) -> SolvedSky:
    return solve(air_of(depth))


AIRS = {
    "earth": air_of(0.05),
    "another planet": OTHER_PLANET.with_stratosphere(stratosphere(0.05, 30_000.0)),
}


def before_the_sun(zenith_deg: float, elevation_deg: np.ndarray) -> tuple[np.ndarray, ...]:
    """mu, mu_s, nu of rays in the sun's azimuth."""
    mu_s, mu = np.cos(np.radians(zenith_deg)), np.sin(np.radians(elevation_deg))
    return mu, mu_s, mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2))


def test_no_aerosol_in_the_stratosphere_is_none() -> None:
    """A layer of depth 0 leaves the air as it is, whatever its altitude: the same object to every
    cache, and so the same light to the last bit."""
    without = air_of(0.0)
    none = stratosphere(0.0)
    assert without.with_stratosphere(none) == without
    assert kinds_of(without) == ("aerosol", "aloft")
    (group,) = groups_of_air(without)
    assert group.stratosphere.shape[1] == 1
    with pytest.raises(ValueError, match="needs the altitude of its peak"):
        without.with_stratosphere(replace(none, peak_m=None))


@pytest.mark.parametrize("name", AIRS)
@pytest.mark.parametrize(("zenith_deg", "within"), [(60.0, 1e-4), (91.0, 2e-3), (94.0, 2e-3)])
def test_light_scattered_once_is_that_of_the_classical_rule(
    name: str, zenith_deg: float, within: float
) -> None:
    """The trapezoid knows neither the tent's kinks nor closed forms of its path."""
    mu, mu_s, nu = before_the_sun(zenith_deg, np.array([8.0, 30.0]))
    truth = single_scattering(AIRS[name], 0.0, mu, mu_s, nu, rule="trapezoid", samples=(2000, 1000))
    ours = single_scattering(AIRS[name], 0.0, mu, mu_s, nu, samples=48)
    assert ours == pytest.approx(truth, rel=within)


@pytest.mark.parametrize("name", AIRS)
@pytest.mark.parametrize("height_m", [0.0, 17_000.0, 40_000.0])
@pytest.mark.parametrize("mu_s", [0.3, -0.01, -0.07])
def test_the_compiled_rule_is_its_twin(name: str, height_m: float, mu_s: float) -> None:
    """As without the layer, from below it, inside it and above it."""
    mu = np.linspace(-1.0, 1.0, 41)
    nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * np.cos(np.arange(41.0))
    exact = scattered_without_phase(AIRS[name], height_m, mu, mu_s, nu)
    fast = fast_scattered_without_phase(AIRS[name], height_m, mu, mu_s, nu)
    for ours, truth in zip(fast, exact, strict=True):
        np.testing.assert_allclose(ours, truth, rtol=1e-6, atol=1e-9 * truth.max())


@pytest.mark.parametrize("name", AIRS)
def test_bins_keep_the_matter_of_the_layer(name: str) -> None:
    """A step's density is the mean of the tent between its ends: 48 steps leave a thousandth of a
    layer's path, also across its peak and at a perigee inside it."""
    air = replace(AIRS[name], absorption_extinction=0.0)
    none = (0.0,) * 4
    alone = replace(
        air, rayleigh_scattering=none, gas_absorption=none, pair_absorption=none,
        mie_scattering=none, mie_extinction=none, aloft_scattering=none, aloft_extinction=none,
    )  # fmt: skip
    (group,) = groups_of_air(alone)
    for altitude_m, mu in [(0.0, 1.0), (0.0, 0.1), (0.0, 0.0), (18_000.0, 0.0), (60_000.0, -0.12)]:
        ray = bins_of_ray(group, altitude_m, mu, (48, 12))
        depth = optical_depth_to_top(alone, altitude_m, mu)
        assert -np.log(ray.end[:4]) == pytest.approx(depth, rel=5e-3)
        # Droplets of sulphuric acid do not absorb.
        assert ray.weight.sum(axis=(0, 1)) == pytest.approx(1.0 - ray.end[:4], abs=1e-9)


def test_the_layer_has_shares_where_it_lies() -> None:
    """All of what particles scatter in its middle, none below 14 km; from the ground as much as
    its part of the depth, from above it nothing."""
    air, high = AIRS["earth"], kinds_of(AIRS["earth"]).index("stratosphere")
    there = shares_at(air, 16, [0.0, 13_000.0, 20_000.0, 27_000.0])[:, high]
    assert there[[0, 1, 3]] == pytest.approx(0.0)
    assert there[2] == pytest.approx(1.0, abs=0.03)
    above = shares_above(air, 16, [0.0, 14_000.0, 27_000.0])[:, high]
    assert above[0] == pytest.approx(0.05 / (TROPOSPHERE_DEPTH + 0.05), abs=0.06)
    assert (above[1] > 0.9).all()
    assert above[2] == pytest.approx(0.0)


@pytest.mark.parametrize("name", AIRS)
def test_no_light_is_lost_in_the_layer(name: str) -> None:
    """Where nothing absorbs, what comes in leaves through the top or into the black ground: the
    solver's orders with a layer as after an eruption add to 1, to 2e-3."""
    air = AIRS[name]
    none = (0.0,) * 4
    air = replace(
        air, ground_radius_m=1e8, mie_extinction=air.mie_scattering,
        aloft_extinction=air.aloft_scattering, absorption_extinction=none, gas_absorption=none,
        pair_absorption=none, ground_albedo=none,
    )  # fmt: skip
    field = solve_field(air, sizes=SolverSizes(node_bins=24), all_orders=True, tolerance=1e-3)
    thin, degree = field.thinned, field.sizes.degree
    x, weight = np.polynomial.legendre.leggauss(16)
    up, turn = 0.5 + 0.5 * x, np.cos((np.arange(24) + 0.5) * np.pi / 24)
    ring = np.repeat(0.5 * weight * up, turn.size) * 2.0 * np.pi / turn.size
    # At one of the solver's own suns, between which light is interpolated.
    suns = SunGrid(air, field.sizes.mu_s).mu_s
    mu_s, total = float(suns[np.abs(suns - 0.6).argmin()]), np.zeros(4)
    for altitude_m, side in ((0.0, 1.0), (air.top_altitude_m, -1.0)):
        mu = np.repeat(side * up, turn.size)
        nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * np.tile(turn, up.size)
        legendre = np.polynomial.legendre.legvander(nu, degree)
        legendre *= (2.0 * np.arange(degree + 1) + 1.0) / (4.0 * np.pi)
        once = fast_by_name(thin, altitude_m, mu, mu_s, nu, 24)
        light = once.pop("molecules") * molecules_phase(air, nu)[:, None]
        for name_of_kind, part in once.items():
            light += part * (legendre @ kept_coefficients(air, degree, name_of_kind).T)
        total += ring @ (light + multiple_scattering(field, altitude_m, mu, mu_s, nu))
    direct = np.exp(-optical_depth_to_top(thin, 0.0, mu_s)) * air.solar_irradiance
    entered = mu_s * np.asarray(air.solar_irradiance)
    assert (total + mu_s * direct) / entered == pytest.approx(np.ones(4), abs=2e-3)


def test_dusk_is_brighter_and_pinker() -> None:
    """The background's 0.005 makes the sky before a sun 2 to 4 degrees down 1.4 to 1.8 times as
    bright, as traced with independent optics (`vrut_lite_lab.polarised_truth`), and redder."""
    traced = {(92.0, 15.0): 1.521, (93.0, 12.0): 1.722, (94.0, 8.0): 1.828, (94.0, 20.0): 1.431}
    for (zenith_deg, elevation_deg), ratio in traced.items():
        where = before_the_sun(zenith_deg, np.array([elevation_deg]))
        clear, veiled = (_rgb(sky_of(depth), *where) for depth in (0.0, 0.005))
        assert luminance(veiled) / luminance(clear) == pytest.approx(ratio, rel=0.02)
        moved = _uv(veiled) - _uv(clear)
        assert 0.005 < np.linalg.norm(moved) < 0.045
        # Towards red and purple, not towards green.
        assert zenith_deg < 93.0 or moved[0] > 0.004


def test_by_day_the_background_is_not_seen() -> None:
    """Of the same column, 0.005 of it higher up: the sky's irradiance changes by less than 0.5 %,
    and so does the sun's."""
    whole = hazy(0.005)
    same = SetHaze(optical_depth_550=whole.optical_depth_550, stratosphere_depth_550=0.0)
    skies = [sky_of(0.005), solve(atmosphere_of(BrunetonSkySettings(), 0.0, same))]
    lights = [sky.irradiance(0.0, np.array([0.3, 0.6, 0.9])) for sky in skies]
    for usual, none in zip(*lights, strict=True):
        change = luminance(_colour(usual)) / luminance(_colour(none)) - 1.0
        assert np.abs(change).max() < 5e-3


def test_a_raised_ground_leaves_the_layer_where_it_is() -> None:
    """Altitudes are measured from the ground; the layer's column stays."""
    low, above = (
        atmosphere_at(HAZE_NM, BrunetonSkySettings(), ground_m, hazy(0.05))
        for ground_m in (0.0, 3000.0)
    )
    layers = [haze_layers(air)[-1] for air in (low, above)]
    assert layers[0].optical_depth == layers[1].optical_depth
    assert layers[1].peak_m == pytest.approx(17_000.0)


def test_the_direct_sun_passes_the_layer_of_all_skies() -> None:
    """A sun in the zenith loses exp(-0.05) to a layer of depth 0.05; a low one is dimmed as by the
    path that both skies share."""
    settings = BrunetonSkySettings()
    with_it, without = (spectral_atmosphere_of(settings, 0.0, hazy(d)) for d in (0.05, 0.0))
    at_550 = with_it.wavelength_nm.index(550.0)
    for sine in (1.0, 0.1, 0.01):
        passed = sun_irradiance(with_it, 0.0, sine) / sun_irradiance(without, 0.0, sine)
        depths = [
            slant_depth(0.0, sine, with_it.wavelength_nm, hazy(d).aerosol_layers) for d in (0.05, 0)
        ]
        assert passed == pytest.approx(np.exp(depths[1] - depths[0]), rel=2e-3)
        if sine == 1.0:
            assert passed[at_550] == pytest.approx(np.exp(-0.05), rel=1e-4)


def test_the_layers_droplets_polarise() -> None:
    """By their own scattering matrix: negative at the side, unlike light that keeps its
    polarisation, and another one after an eruption."""
    nu = np.cos(np.radians([60.0, 90.0, 120.0]))
    usual, volcanic = (
        particles_polarisation(air_of(depth), "stratosphere", nu)[0] for depth in (0.005, 0.3)
    )
    assert (usual[1] < -0.1).all()
    assert np.abs(usual - volcanic).max() > 0.2


def test_the_published_tables_refuse_the_layer() -> None:
    """Their transmittance has exponential layers only."""
    with pytest.raises(ValueError, match="aerosol in the stratosphere"):
        precompute(Atmosphere.earth().with_stratosphere(stratosphere(0.05)))


def test_the_picture_of_dusk_is_that_of_exact_rays() -> None:
    """A layer as after an eruption: luminance of the cube map before a sun 3 degrees down is that
    of rays with 32 nodes between the layer's kinks, to 3 %."""
    down = np.radians(3.0)
    sun = np.array([0.0, -np.sin(down), -np.cos(down)])
    towards = texel_directions(16)
    seen = (towards[..., 1] > 0.05) & (towards[..., 2] < -0.4)
    mu = towards[seen][:, 1]
    exact = sky_of(0.05).radiance_rgb(0.0, mu, float(sun[1]), towards[seen] @ sun)
    shown = sky_of(0.05).cube_map(16, sun)[seen]
    assert luminance(shown) == pytest.approx(luminance(exact), rel=0.03)


@pytest.mark.parametrize("altitude_m", [0.0, 8000.0, 4e5])
@pytest.mark.parametrize(("elevation_deg", "most"), [(3.0, 0.015), (-4.0, 0.015), (-9.0, 0.03)])
def test_a_table_of_twilight_has_bins_enough(
    altitude_m: float, elevation_deg: float, most: float
) -> None:
    """Where the planet's shadow and the layer's kinks cut through rays, 99 of 100 nodes of a table
    have the light of rays divided ten times as finely within 1.5 % in all four wavelengths, 9
    degrees down 3 % (half as many bins erred by 3 to 6 % from aloft and space, by 15 % after an
    eruption)."""
    mu_s = float(np.sin(np.radians(elevation_deg)))
    for depth in (0.005, 0.05):
        field = sky_of(depth).field
        in_space = altitude_m > field.atmosphere.top_altitude_m
        rows = table_rows(field.atmosphere, altitude_m, mu_s, 32, 0, 24)
        counts = table_counts(field.atmosphere, altitude_m, mu_s)
        shown = total_radiance(field, rows, limb_counts(counts) if in_space else counts)
        fine = total_radiance(field, rows, (1000, 1000, counts[2]))
        scale = np.maximum(fine, 1e-3 * fine.max(axis=(0, 1)))
        assert np.quantile(np.abs(shown - fine) / scale, 0.99) < most


def _rgb(sky: SolvedSky, mu: np.ndarray, mu_s: float, nu: np.ndarray) -> np.ndarray:
    return _colour(sky.radiance(0.0, mu, mu_s, nu))[0]


def _colour(light: np.ndarray) -> np.ndarray:
    return rgb_from_spectrum(light, SKYLIGHT_NM, 3.0)


def _uv(rgb: np.ndarray) -> np.ndarray:
    """CIE 1976 u', v' (2,) of linear sRGB (3,)."""
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    x, y, z = to_xyz @ rgb
    return np.array([4.0 * x, 9.0 * y]) / (x + 15.0 * y + 3.0 * z)

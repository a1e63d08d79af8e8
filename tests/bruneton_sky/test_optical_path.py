"""Optical paths: the closed form against adaptive quadrature along the ray."""

from itertools import pairwise

import numpy as np
import pytest
from bruneton_sky import Atmosphere, path_kernels
from bruneton_sky.geometry import (
    altitude_along,
    distance_to_ground,
    distance_to_top,
    end_of_ray,
    make_ray,
)
from bruneton_sky.optical_path import (
    exponential_layers_path,
    exponential_path,
    layered_path,
    optical_depth_to_top,
)
from bruneton_sky.presets import earth_standard
from scipy.integrate import quad

HEIGHTS_M = (0.0, 1.7, 3000.0, 25_000.0, 59_000.0)
COSINES = (1.0, 0.4, 0.05, 1e-3, 0.0, -0.02, -0.1, -0.6, -1.0)


def along_ray(  # type: ignore[no-untyped-def]
    atmosphere: Atmosphere, height_m: float, mu: float, density, kinks_m: tuple[float, ...] = ()
) -> float:
    """Integral of density(altitude) over the ray's length, split where it could kink."""
    radius = atmosphere.ground_radius_m
    if make_ray(radius, height_m, mu).hits_ground():
        length = float(distance_to_ground(radius, height_m, mu))
    else:
        length = float(distance_to_top(radius, atmosphere.top_altitude_m, height_m, mu))
    splits = [0.0, length]
    for altitude in (*atmosphere.absorber_altitude_m, *kinks_m, None):
        splits += crossings(radius, height_m, mu, altitude)
    edges = np.unique(np.clip(splits, 0.0, length))
    pieces = [
        quad(lambda s: density(altitude_along(radius, height_m, mu, s)), a, b, epsrel=1e-12)[0]
        for a, b in pairwise(edges)
    ]
    return float(sum(pieces))


def crossings(radius: float, height_m: float, mu: float, altitude: float | None) -> list[float]:
    """Distances to an altitude, or to the perigee for None."""
    b = (radius + height_m) * mu
    if altitude is None:
        return [-b]
    c = (altitude - height_m) * (2 * radius + altitude + height_m)
    root = np.sqrt(max(b * b + c, 0.0))
    return [-b - root, -b + root]


@pytest.mark.parametrize("height_m", HEIGHTS_M)
def test_exponential_path_on_earth(height_m: float) -> None:
    """The closed form errs by at most 4e-8 on Earth, 7e-10 upward, through any perigee."""
    earth = Atmosphere.earth()
    for scale in (8000.0, 1200.0):
        for mu in COSINES:
            ray = make_ray(earth.ground_radius_m, height_m, mu)
            ours = exponential_path(ray, *end_of_ray(ray, earth.top_altitude_m), scale)
            truth = along_ray(earth, height_m, mu, lambda h, s=scale: np.exp(-h / s))
            tolerance = 1e-9 if mu >= 0 else 5e-8
            # An absolute micrometre: paths that short are differences of kilometres.
            assert ours == pytest.approx(truth, rel=tolerance, abs=1e-6), (scale, mu)


@pytest.mark.parametrize("height_m", HEIGHTS_M)
def test_exponential_path_on_another_planet(other_planet: Atmosphere, height_m: float) -> None:
    """Where scale height over radius is three times Earth's, the series ends 27 times sooner."""
    scale = other_planet.rayleigh_scale_height_m
    for mu in COSINES:
        ray = make_ray(other_planet.ground_radius_m, height_m, mu)
        ours = exponential_path(ray, *end_of_ray(ray, other_planet.top_altitude_m), scale)
        truth = along_ray(other_planet, height_m, mu, lambda h: np.exp(-h / scale))
        assert ours == pytest.approx(truth, rel=2e-8 if mu >= 0 else 3e-6, abs=1e-6), mu


@pytest.mark.parametrize("height_m", HEIGHTS_M)
def test_path_through_layers_of_several_scale_heights(height_m: float) -> None:
    """Each layer by its closed form, in numpy and compiled: rays up, down and through perigees."""
    air = earth_standard()
    planet, top_m, layers = air.ground_radius_m, air.top_altitude_m, air.molecule_layers
    for mu in COSINES:
        ray = make_ray(planet, height_m, mu)
        end = end_of_ray(ray, top_m)
        ours = exponential_layers_path(ray, *end, layers)
        truth = along_ray(air, height_m, mu, layers.density, layers.base_m[1:])
        assert ours == pytest.approx(truth, rel=2e-7, abs=1e-6), mu
        end_m, end_y = map(float, end)
        start, stop = map(float, layers.density([height_m, end_m]))
        compiled = path_kernels.exponential_layers_path(
            path_kernels.make_ray(planet, height_m, mu), start, end_m, end_y, stop, layers.array()
        )
        assert compiled == pytest.approx(float(ours), rel=1e-8, abs=1e-6), mu


@pytest.mark.parametrize("height_m", HEIGHTS_M)
def test_layered_path(other_planet: Atmosphere, height_m: float) -> None:
    """Three nodes on each linear piece leave 3e-10 on Earth and little more elsewhere."""
    for planet in (Atmosphere.earth(), other_planet):
        layers = planet.absorber_altitude_m, planet.absorber_density
        for mu in COSINES:
            ray = make_ray(planet.ground_radius_m, height_m, mu)
            ours = layered_path(ray, end_of_ray(ray, planet.top_altitude_m)[1], *layers)
            truth = along_ray(planet, height_m, mu, planet.absorber)
            assert ours == pytest.approx(truth, rel=2e-8, abs=1e-6), mu


def test_vertical_optical_depth_is_a_column(other_planet: Atmosphere) -> None:
    """Straight up, depth is coefficient times column: H (1 - e^(-top/H)), the layers exactly."""
    p = other_planet
    columns = [
        scale * -np.expm1(-p.top_altitude_m / scale)
        for scale in (p.rayleigh_scale_height_m, p.mie_scale_height_m)
    ]
    absorber = np.trapezoid(p.absorber_density, p.absorber_altitude_m)
    expected = (
        np.array(p.rayleigh_scattering) * columns[0]
        + np.array(p.mie_extinction) * columns[1]
        + np.array(p.absorption_extinction) * absorber
    )
    assert optical_depth_to_top(p, 0.0, 1.0) == pytest.approx(expected, rel=2e-8)

"""Backward Monte Carlo of a spherical atmosphere: light that was scattered twice and more.

A path starts at the eye and goes from scatterer to scatterer, or to the ground; from each, the
sun is sought directly (next-event estimation) through closed-form optical paths. All wavelengths
share one path, weighted. What makes twilight affordable is in `distances` and `directions`; the
estimate is unbiased whatever they prefer, and only its variance depends on them.
"""

# ruff: noqa: NPY002 (inside compiled code the seed is set and used where nothing else draws)

import math

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.kernels import _jacobian
from numpy.typing import NDArray

from tools.twilight_fit.directions import draw_direction, lobe_axis, set_scattering, turn, upward
from tools.twilight_fit.distances import BINS, draw_distance, set_edges, weigh_bins
from tools.twilight_fit.medium import (
    compiled,
    densities,
    dim,
    distance_to,
    dot,
    make_ray,
    medium_of,
    y_at_top,
)

FloatArray = NDArray[np.float64]
ORDERS = 8
# Below this share of the first weight a path goes on by chance only.
ROULETTE = 1e-3


def scattered_radiance(
    atmosphere: Atmosphere,
    mu: float,
    azimuth_rad: float,
    mu_s: float,
    paths: int,
    seed: int,
    altitude_m: float = 0.0,
) -> tuple[FloatArray, FloatArray]:
    """Radiance by order of scattering per unit of solar irradiance, and the error of the sum.

    Args:
        atmosphere: C wavelengths; its solar irradiance is not used.
        mu: cosine of the view direction's zenith angle; the ray must not meet the ground.
        azimuth_rad: of the view direction from the sun's.
        mu_s: cosine of the sun's zenith angle.
        paths: how many.
        seed: of the random numbers; equal seeds give equal results.
        altitude_m: of the eye.

    Returns:
        means (ORDERS, C) in sr^-1, first order first, reflections counted as scatterings; and
        the standard error (C,) of the sum over the orders from the second on.
    """
    medium = medium_of(atmosphere)
    sine = math.sqrt((1.0 - mu) * (1.0 + mu))
    view = np.array([sine * math.cos(azimuth_rad), sine * math.sin(azimuth_rad), mu])
    sun = np.array([math.sqrt((1.0 - mu_s) * (1.0 + mu_s)), 0.0, mu_s])
    means = np.zeros((ORDERS, medium.albedo.size))
    squares = np.zeros(medium.albedo.size)
    _trace(medium, float(altitude_m), view, sun, paths, seed, means, squares)
    means /= paths
    multiple = means[1:].sum(axis=0)
    error = np.sqrt(np.maximum(squares / paths - multiple**2, 0.0) / paths)
    return means, error


@compiled
def _trace(medium, eye_altitude, view, sun, paths, seed, sums, squares):  # type: ignore[no-untyped-def]
    np.random.seed(seed)
    count = sums.shape[1]
    weight, scratch = np.empty(count), np.empty(count)
    point, direction = np.empty(3), np.empty(3)
    edges, cumulative = np.empty(BINS + 1), np.empty((2, BINS))
    one = np.empty((ORDERS, count))
    for path in range(paths):
        point[:2] = 0.0
        point[2] = medium.radius + eye_altitude
        direction[:] = view
        weight[:] = 1.0
        one[:] = 0.0
        altitude = eye_altitude
        for order in range(ORDERS):
            u = np.random.random()
            if order == 0:
                # The first distance is stratified over the paths, and never the ground.
                u = (path + u) / paths
            altitude, on_ground = _advance(
                medium, altitude, point, direction, sun, weight, scratch, edges, cumulative, u,
                order > 0,
            )  # fmt: skip
            if altitude < 0.0:
                break
            if on_ground:
                _reflect(medium, point, direction, sun, weight, scratch, one[order])
            else:
                _scatter(medium, altitude, point, direction, sun, weight, scratch, one[order])
            if not _goes_on(weight):
                break
        sums += one
        for c in range(count):
            squares[c] += one[1:, c].sum() ** 2


@compiled
def _goes_on(weight):  # type: ignore[no-untyped-def]
    """Russian roulette with light paths."""
    chance = weight.max() / ROULETTE
    if chance < 1.0:
        if np.random.random() >= chance:
            return False
        weight /= chance
    return True


@compiled
def _advance(  # type: ignore[no-untyped-def]
    medium, altitude, point, direction, sun, weight, depth, edges, cumulative, u, may_land
):
    """Move the point to the next event: its altitude (negative: none) and if it is the ground.

    The weight takes in transmittance over probability density; what the event itself does to it
    is for `_scatter` and `_reflect`.
    """
    radius = medium.radius + altitude
    mu_s = min(max(dot(point, sun) / radius, -1.0), 1.0)
    ray = make_ray(medium.radius, altitude, min(max(dot(point, direction) / radius, -1.0), 1.0))
    hits = ray[4] < 0.0 and ray[3] <= 0.0
    set_edges(medium, ray, hits, edges)
    weigh_bins(medium, ray, mu_s, dot(direction, sun), weight, depth, edges, cumulative)
    ground = 0.0
    if hits and may_land:
        for c in range(weight.size):
            ground += weight[c] * math.exp(-depth[c]) * medium.albedo[c] / weight.size
    total = cumulative[0, BINS - 1] + ground
    if total <= 0.0:
        return -1.0, False
    ground /= total
    if u < ground:
        dim(medium, ray, 0.0, edges[BINS], 1.0 / ground, weight)
        _move(point, direction, distance_to(ray, edges[BINS]))
        _onto_ground(point, medium.radius)
        return 0.0, True
    y, density = draw_distance(cumulative, edges, (u - ground) / (1.0 - ground))
    density *= (1.0 - ground) / _jacobian(ray[2], y)
    here = min(max(ray[3] + y * y, 0.0), medium.top)
    dim(medium, ray, here, y, 1.0 / density, weight)
    _move(point, direction, distance_to(ray, y))
    return here, False


@compiled
def _add_sun(medium, altitude, point, sun, weight, factor, out):  # type: ignore[no-untyped-def]
    """Add the direct sun at a point, seen through the air: weight * factor * transmittance."""
    cosine = min(max(dot(point, sun) / (medium.radius + altitude), -1.0), 1.0)
    ray = make_ray(medium.radius, altitude, cosine)
    if cosine < 0.0 and ray[3] <= 0.0:
        return
    for c in range(weight.size):
        factor[c] *= weight[c]
    dim(medium, ray, medium.top, y_at_top(medium, ray), 1.0, factor)
    out += factor


@compiled
def _scatter(medium, altitude, point, direction, sun, weight, factor, out):  # type: ignore[no-untyped-def]
    """Add the sun's light scattered here, and draw the direction that the path goes on in."""
    thin, haze = densities(medium, altitude)
    set_scattering(medium, thin, haze, dot(direction, sun), factor)
    _add_sun(medium, altitude, point, sun, weight, factor, out)
    molecules, aerosol = 0.0, 0.0
    for c in range(weight.size):
        molecules += weight[c] * medium.scattering[0, c] * thin
        aerosol += weight[c] * medium.scattering[1, c] * haze
    cosine, density = draw_direction(
        medium.g, aerosol / (aerosol + molecules), lobe_axis(point, sun), direction
    )
    set_scattering(medium, thin, haze, cosine, factor)
    for c in range(weight.size):
        weight[c] *= factor[c] / density


@compiled
def _reflect(medium, point, direction, sun, weight, factor, out):  # type: ignore[no-untyped-def]
    """The same at Lambertian ground, whose next direction follows the cosine."""
    cosine = dot(point, sun) / medium.radius
    for c in range(weight.size):
        weight[c] *= medium.albedo[c]
        factor[c] = max(cosine, 0.0) / math.pi
    _add_sun(medium, 0.0, point, sun, weight, factor, out)
    turn(upward(point), math.sqrt(np.random.random()), direction)


@compiled
def _move(point, direction, distance):  # type: ignore[no-untyped-def]
    for i in range(3):
        point[i] += distance * direction[i]


@compiled
def _onto_ground(point, radius):  # type: ignore[no-untyped-def]
    scale = radius / math.sqrt(dot(point, point))
    for i in range(3):
        point[i] *= scale

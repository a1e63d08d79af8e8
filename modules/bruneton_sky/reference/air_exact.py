"""The air before a point, in float64: the reference for `air_volume`.

A ray is cut where it meets the level, the edges of the planet's shadow and its own perigee, and
each piece is integrated by Gauss and Legendre's rule on shrinking intervals, with optical depths
in closed form. Light scattered more than once has the solver's source function, looked up in
float64. As in an `AirVolume`, a ray does not end on the ground: below level 0 density, source
and sun's transmittance are those of level 0.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import (
    Ray,
    altitude_along,
    distance_to_ground,
    distance_to_top,
    in_earth_shadow,
    make_ray,
    shadow_boundary,
)
from bruneton_sky.single_scattering import optical_depth, optical_depth_to_top
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.grid import SunGrid
from bruneton_sky.solver.wavelength_groups import dense_layer, wavelengths_of_groups
from vrut_lite.numeric_types import FloatArray

_NODES = 6


class AirLight(NamedTuple):
    """What air does along a ray up to n distances, (n, C) each, W m^-2 sr^-1 nm^-1.

    `molecules` and `aerosol`: sunlight scattered once, without phase functions; `more`: light
    scattered twice or more.
    """

    transmittance: FloatArray
    molecules: FloatArray
    aerosol: FloatArray
    more: FloatArray


def light_before(
    field: SourceField,
    altitude_m: float,
    mu: float,
    mu_s: float,
    nu: float,
    distance_m: FloatArray,
    pieces: int = 48,
) -> AirLight:
    """The air before rising distances (n,) on one ray from an altitude inside the air.

    Past the edge of the air nothing is added. `pieces`: into how many intervals the ray is cut
    between two of the distances, at least.
    """
    air = field.atmosphere
    planet = air.ground_radius_m, air.top_altitude_m
    inside_m = distance_m
    if not make_ray(planet[0], altitude_m, mu).hits_ground():
        inside_m = np.minimum(distance_m, distance_to_top(*planet, altitude_m, mu))
    edges = _edges(air, altitude_m, mu, mu_s, nu, inside_m, pieces)
    x, w = np.polynomial.legendre.leggauss(_NODES)
    half = 0.5 * np.diff(edges)[:, None]
    metres = (edges[:-1, None] + half * (1.0 + x)).ravel()
    share = (half * w).ravel()
    through = np.exp(-depth_along(air, altitude_m, mu, metres))
    there = altitude_along(air.ground_radius_m, altitude_m, mu, metres)
    radius, level = air.ground_radius_m + altitude_m, np.maximum(there, 0.0)
    sun = np.clip((radius * mu_s + metres * nu) / (air.ground_radius_m + there), -1.0, 1.0)
    cosine = np.clip((radius * mu + metres) / (air.ground_radius_m + there), -1.0, 1.0)
    lit = np.exp(-optical_depth_to_top(air, level, sun)) * np.asarray(air.solar_irradiance)
    lit[in_earth_shadow(air.ground_radius_m, there, sun)] = 0.0
    molecules, aerosol = scattering_at(air, level)
    again = source_at(field, level, cosine, sun, np.full(metres.shape, nu))
    weight = through * share[:, None]
    parts = (lit * molecules, lit * aerosol, again[0] * molecules + again[1] * aerosol)
    ends = np.searchsorted(metres, inside_m)
    sums = (np.concatenate([np.zeros_like(p[:1]), np.cumsum(weight * p, axis=0)]) for p in parts)
    transmittance = np.exp(-depth_along(air, altitude_m, mu, inside_m))
    return AirLight(transmittance, *(part[ends] for part in sums))


def depth_along(
    atmosphere: Atmosphere, altitude_m: float, mu: float, distance_m: FloatArray
) -> FloatArray:
    """Optical depth (n, C) up to distances on a ray, inside the air.

    Below level 0 the air is that of level 0.
    """
    ray = make_ray(atmosphere.ground_radius_m, altitude_m, mu)
    level = np.inf
    if ray.hits_ground():
        level = float(distance_to_ground(atmosphere.ground_radius_m, altitude_m, mu))
    above = np.minimum(distance_m, level)
    end = altitude_along(atmosphere.ground_radius_m, altitude_m, mu, above)
    end = np.clip(end, 0.0, atmosphere.top_altitude_m)
    depth = optical_depth(atmosphere, ray, end, _y_at(ray, above))
    below = np.sum([kind.extinction for kind in atmosphere.scatterers()], axis=0)
    below = below + atmosphere.absorber(0.0) * np.asarray(atmosphere.absorption_extinction)
    return depth + (distance_m - above)[:, None] * below


def scattering_at(atmosphere: Atmosphere, altitude_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Scattering coefficients (n, C) in 1/m of molecules, and of all that has aerosol's phase."""
    molecules, *rest = (
        np.exp(-altitude_m / kind.scale_height_m)[:, None] * kind.scattering
        for kind in atmosphere.scatterers()
    )
    return molecules, np.sum(rest, axis=0)


def source_at(
    field: SourceField, altitude_m: FloatArray, mu: FloatArray, mu_s: FloatArray, nu: FloatArray
) -> FloatArray:
    """The source function (2, n, C) of molecules and aerosol at points; see `SourceField`."""
    air, count = field.atmosphere, len(field.atmosphere.wavelength_nm)
    height = _altitude_place(air, altitude_m)
    sun = SunGrid(air, field.sizes.mu_s).place(mu_s)
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    sines = np.maximum(sine * np.sqrt((1.0 - mu_s) * (1.0 + mu_s)), 1e-12)
    turn = np.clip((nu - mu * mu_s) / sines, -1.0, 1.0)
    out = np.zeros((2, mu.size, count))
    if field.rayleigh.shape[1] > 0:
        table = _by_sun(field.rayleigh, count)
        values = _blend(np.moveaxis(table, 2, 1), (height, sun))
        terms = np.stack(
            [np.ones_like(mu), 3.0 * mu * mu - 1.0, mu * sine * turn, sine**2 * (2 * turn**2 - 1)]
        )
        out[0] = np.einsum("tn,ntc->nc", terms, values)
    if field.mie.shape[1] > 0:
        table = _by_sun(field.mie, count)
        places = height, 0.5 * mu + 0.5, np.sqrt(0.5 * (1.0 - turn)), sun
        out[1] = _blend(table, places)
    return out


def _altitude_place(air: Atmosphere, altitude_m: FloatArray) -> FloatArray:
    """Place (n,) in [0, 1] on the source's axis of altitudes: see `solver.ray_kernels`."""
    radius, top = air.ground_radius_m, air.top_altitude_m
    squares = altitude_m * (2.0 * radius + altitude_m) / (top * (2.0 * radius + top))
    place = np.sqrt(np.clip(squares, 0.0, 1.0))
    reach_m, share = dense_layer(air)
    in_layer = np.expm1(-altitude_m / reach_m) / np.expm1(-top / reach_m)
    return np.asarray(place + share * (in_layer - place))


def _by_sun(table: NDArray[np.float32], count: int) -> FloatArray:
    """(groups, ..., suns * 4) as (..., suns, C)."""
    return wavelengths_of_groups(table.reshape(*table.shape[:-1], -1, 4), count)


def _blend(table: FloatArray, places: tuple[FloatArray, ...]) -> FloatArray:
    """Values (n, ...) between nodes along the first axes, at places in [0, 1]; linear."""
    low, share = [], []
    for place, size in zip(places, table.shape, strict=False):
        low.append(np.minimum((place * (size - 1)).astype(np.intp), size - 2))
        share.append(place * (size - 1) - low[-1])
    rest = (1,) * (table.ndim - len(places))
    out = np.zeros((places[0].size, *table.shape[len(places) :]))
    for corner in np.ndindex(*(2,) * len(places)):
        sides = zip(corner, share, strict=True)
        weight = np.prod([part if side else 1.0 - part for side, part in sides], axis=0)
        index = tuple(near + side for near, side in zip(low, corner, strict=True))
        out += weight.reshape(-1, *rest) * table[index]
    return out


def _edges(
    air: Atmosphere,
    altitude_m: float,
    mu: float,
    mu_s: float,
    nu: float,
    distance_m: FloatArray,
    pieces: int,
) -> FloatArray:
    """Distances between which everything along a ray is smooth, and short."""
    ray = make_ray(air.ground_radius_m, altitude_m, mu)
    marks = [-float(ray.radius_m) * mu, *(float(s) for s in shadow_boundary(ray, mu_s, nu))]
    if ray.hits_ground():
        marks.append(float(distance_to_ground(air.ground_radius_m, altitude_m, mu)))
    last = float(distance_m[-1])
    ends = np.unique([0.0, *distance_m, *(m for m in marks if 0.0 < m < last)])
    parts = [np.linspace(a, b, pieces + 1)[:-1] for a, b in pairwise(ends)]
    return np.concatenate([*parts, ends[-1:]])


def _y_at(ray: Ray, distance_m: FloatArray) -> FloatArray:
    """y (n,) of distances on a ray; see `geometry`."""
    along = ray.radius_m * ray.mu + distance_m
    p = ray.perigee_radius_m
    return along / np.sqrt(np.maximum(p + np.sqrt(p * p + along * along), 1e-300))

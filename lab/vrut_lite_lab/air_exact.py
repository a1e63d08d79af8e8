"""The air before a point, in float64: the reference for `air_volume`.

A ray is cut at ground level, at the edges of the planet's shadow and at its perigee; each piece is
integrated by Gauss and Legendre's rule on shrinking intervals, with optical depths
in closed form. Light scattered more than once has the solver's source function, looked up in
float64. As in an `AirVolume`, a ray does not end on the ground: below level 0 density, source
and sun's transmittance are those of level 0.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import (
    altitude_along,
    distance_to_ground,
    distance_to_top,
    in_earth_shadow,
    make_ray,
    shadow_boundary,
    y_along,
)
from bruneton_sky.optical_path import optical_depth, optical_depth_to_top
from bruneton_sky.phase import molecules_phase, particles_phase, rayleigh_phase
from bruneton_sky.ray_light import scattering_at, source_at
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.delta_m import forward_shares

from vrut_lite.numeric_types import FloatArray

_NODES = 6


class ExactAirLight(NamedTuple):
    """Light and transmittance along a ray up to n distances, (n, C) each, W m^-2 sr^-1 nm^-1.

    Sunlight scattered once: `molecules` over Rayleigh's phase function, `aerosol` over its own;
    `once`: both with the phase functions of each kind; `more`: light scattered twice or more.
    """

    transmittance: FloatArray
    molecules: FloatArray
    aerosol: FloatArray
    once: FloatArray
    more: FloatArray


def light_before(
    field: SourceField,
    altitude_m: float,
    mu: float,
    mu_s: float,
    nu: float,
    distance_m: FloatArray,
    pieces: int = 48,
) -> ExactAirLight:
    """The air before rising distances (n,) on one ray from an altitude inside the air.

    Past the edge of the air nothing is added. `pieces`: least number of intervals between two of
    the distances.
    """
    air = field.thinned
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
    scattering = scattering_at(air, level)
    molecules = scattering.pop("molecules")
    aerosol = np.sum(list(scattering.values()), axis=0)
    phase = molecules_phase(air, nu)
    shown = molecules * phase
    for name, part in scattering.items():
        peak = forward_shares(field.atmosphere, field.sizes.degree)[name]
        shown = shown + part * particles_phase(air, name, nu) / (1.0 - peak)
    again = source_at(field, level, cosine, sun, np.full(metres.shape, nu))
    weight = through * share[:, None]
    more = again[0] * molecules + again[1] * aerosol
    parts = (lit * molecules * phase / rayleigh_phase(nu), lit * aerosol, lit * shown, more)
    ends = np.searchsorted(metres, inside_m)
    sums = (np.concatenate([np.zeros_like(p[:1]), np.cumsum(weight * p, axis=0)]) for p in parts)
    transmittance = np.exp(-depth_along(air, altitude_m, mu, inside_m))
    return ExactAirLight(transmittance, *(part[ends] for part in sums))


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
    depth = optical_depth(atmosphere, ray, end, y_along(ray, above))
    below = np.sum([kind.extinction for kind in atmosphere.scatterers()], axis=0)
    below = below + atmosphere.absorber(0.0) * np.asarray(atmosphere.absorption_extinction)
    return depth + (distance_m - above)[:, None] * below


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

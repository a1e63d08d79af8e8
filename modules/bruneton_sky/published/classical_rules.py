"""Midpoint, trapezoid and Simpson with even intervals: the textbook rules.

They use neither y nor closed forms nor the shadow's edge, and so check the other rule
independently. The view ray's optical depth is accumulated by the rule itself: a midpoint
takes half of its cell, and Simpson's odd nodes the parabola through their neighbours.
"""

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import (
    altitude_along,
    distance_to_ground,
    distance_to_top,
    in_earth_shadow,
    make_ray,
)
from vrut_lite.arguments import as_count, check_choice, shown
from vrut_lite.numeric_types import FloatArray

RULES = ("midpoint", "trapezoid", "simpson")
_MOST_INTERVALS = 16_384


def classical_integrals(
    atmosphere: Atmosphere,
    altitude_m: FloatArray,
    mu: FloatArray,
    mu_s: FloatArray,
    nu: FloatArray,
    rule: str,
    samples: int | tuple[int, int],
) -> list[FloatArray]:
    """I_X (..., C) in m of each scatterer, as `single_scattering` defines them.

    Raises:
        ValueError: the rule is unknown, or the intervals do not suit it.
    """
    view, light = checked_intervals(rule, samples)
    length = _length(atmosphere, altitude_m, mu)
    fraction, weight = rule_nodes(rule, view)
    radius = atmosphere.ground_radius_m
    distance = length[..., None] * fraction
    start, cosine = altitude_m[..., None], mu[..., None]
    there_m = altitude_along(radius, start, cosine, distance)
    # Rounding must not put a node outside the air.
    altitude = np.clip(there_m, 0.0, atmosphere.top_altitude_m)
    view_depth = _optical_depth(
        atmosphere,
        [accumulate(rule, d, length[..., None] / view) for d in _densities(atmosphere, altitude)],
    )
    there = (radius + start) * mu_s[..., None] + distance * nu[..., None]
    mu_s_there = np.clip(there / (radius + altitude), -1.0, 1.0)
    # One node of the view ray at a time: all at once would hold view x light values per ray.
    light_depth = np.stack(
        [
            _light_depth(atmosphere, altitude[..., i], mu_s_there[..., i], rule, light)
            for i in range(fraction.size)
        ],
        axis=-2,
    )
    lit = ~in_earth_shadow(radius, altitude, mu_s_there)
    reaching = np.exp(-view_depth - light_depth) * lit[..., None]
    *scatterers, _ = _densities(atmosphere, altitude)
    metres = length[..., None] * weight
    return [np.einsum("...n,...nc->...c", metres * density, reaching) for density in scatterers]


def rule_nodes(rule: str, intervals: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of a rule on [0, 1]."""
    if rule == "midpoint":
        return (np.arange(intervals) + 0.5) / intervals, np.full(intervals, 1.0 / intervals)
    nodes = np.arange(intervals + 1) / intervals
    if rule == "trapezoid":
        weight = np.full(intervals + 1, 1.0)
        weight[[0, -1]] = 0.5
    else:
        weight = np.where(np.arange(intervals + 1) % 2 == 1, 4.0, 2.0) / 3.0
        weight[[0, -1]] = 1.0 / 3.0
    return nodes, weight / intervals


def accumulate(rule: str, values: FloatArray, step: FloatArray) -> FloatArray:
    """Integral (..., n) of values (..., n) at a rule's nodes, from the start up to each node."""
    if rule == "midpoint":
        return (np.cumsum(values, axis=-1) - 0.5 * values) * step
    integral = np.zeros_like(values)
    if rule == "trapezoid":
        integral[..., 1:] = np.cumsum(0.5 * (values[..., 1:] + values[..., :-1]), axis=-1)
        return integral * step
    first, middle, last = values[..., :-2:2], values[..., 1::2], values[..., 2::2]
    integral[..., 2::2] = np.cumsum((first + 4.0 * middle + last) / 3.0, axis=-1)
    # Where values grow steeply the parabola dips below zero, which a depth must not.
    part = np.maximum(5.0 * first + 8.0 * middle - last, 0.0) / 12.0
    integral[..., 1::2] = integral[..., :-2:2] + part
    return integral * step


def checked_intervals(rule: str, samples: int | tuple[int, int]) -> tuple[int, int]:
    """The intervals (view, light), checked for the rule.

    Raises:
        ValueError: they do not, or there is no such rule.
    """
    check_choice("rule", rule, ("gauss-legendre", *RULES))
    if not isinstance(samples, tuple) or len(samples) != 2:
        raise ValueError(f"samples of {rule} must be intervals (view, light), not {shown(samples)}")
    view, light = (as_count(f"samples of {rule}", count, 1, _MOST_INTERVALS) for count in samples)
    if rule == "simpson" and (view % 2 or light % 2):
        raise ValueError(f"samples of simpson must be even, not {samples!r}")
    return view, light


def _length(atmosphere: Atmosphere, altitude_m: FloatArray, mu: FloatArray) -> FloatArray:
    radius = atmosphere.ground_radius_m
    to_ground = distance_to_ground(radius, altitude_m, mu)
    to_top = distance_to_top(radius, atmosphere.top_altitude_m, altitude_m, mu)
    return np.where(make_ray(radius, altitude_m, mu).hits_ground(), to_ground, to_top)


def _light_depth(
    atmosphere: Atmosphere, altitude_m: FloatArray, mu_s: FloatArray, rule: str, intervals: int
) -> FloatArray:
    radius, top = atmosphere.ground_radius_m, atmosphere.top_altitude_m
    fraction, weight = rule_nodes(rule, intervals)
    length = distance_to_top(radius, top, altitude_m, mu_s)[..., None]
    altitude = altitude_along(radius, altitude_m[..., None], mu_s[..., None], length * fraction)
    # Through the planet the density would overflow; such a point is dark and its depth unused.
    densities = _densities(atmosphere, np.maximum(altitude, 0.0))
    return _optical_depth(atmosphere, [(d * weight * length).sum(axis=-1) for d in densities])


def _densities(atmosphere: Atmosphere, altitude_m: FloatArray) -> list[FloatArray]:
    """Relative densities (...,) of each scatterer and of the absorber."""
    densities = [kind.density(altitude_m) for kind in atmosphere.scatterers()]
    return [*densities, atmosphere.absorber(altitude_m)]


def _optical_depth(atmosphere: Atmosphere, paths: list[FloatArray]) -> FloatArray:
    scatterers = atmosphere.scatterers()
    coefficients = *(kind.extinction for kind in scatterers), atmosphere.absorption_extinction
    pairs = zip(paths, coefficients, strict=True)
    return sum((p[..., None] * np.asarray(k) for p, k in pairs), np.zeros(()))

"""Altitudes and directions as lengths of tangents to the ground and of rays.

rho is the length of the tangent from a point to the ground, H that from the top of the
atmosphere. Squares are kept factored, rho^2 = h (2 R + h), so that nothing is lost at the
ground, at the horizon or at the top.
"""

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import distance_to_ground
from vrut_lite.numeric_types import FloatArray


def tangent(air: Atmosphere, altitude_m: ArrayLike) -> FloatArray:
    """rho (...,) in m."""
    h = np.asarray(altitude_m, dtype=float)
    return np.sqrt(h * (2.0 * air.ground_radius_m + h))


def unit_of_altitude(air: Atmosphere, altitude_m: ArrayLike) -> FloatArray:
    """rho / H: 0 at the ground, 1 at the top (thesis, equation 2.31)."""
    return tangent(air, altitude_m) / tangent(air, air.top_altitude_m)


def altitude_of_unit(air: Atmosphere, unit: ArrayLike) -> FloatArray:
    """The altitude (...,) in m whose rho / H is given; exactly the top at 1."""
    rho_squared = (np.asarray(unit, dtype=float) * tangent(air, air.top_altitude_m)) ** 2
    ground = air.ground_radius_m
    altitude = rho_squared / (ground + np.sqrt(rho_squared + ground * ground))
    return np.minimum(altitude, air.top_altitude_m)


def to_ground(air: Atmosphere, altitude_m: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """The shortest (straight down) and the longest (tangent) ray to the ground."""
    return np.asarray(altitude_m, dtype=float), tangent(air, altitude_m)


def to_top(air: Atmosphere, altitude_m: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """The shortest (straight up) and the longest (tangent to the ground) ray to the top."""
    shortest = air.top_altitude_m - np.asarray(altitude_m, dtype=float)
    return shortest, tangent(air, altitude_m) + tangent(air, air.top_altitude_m)


def ground_distance(
    air: Atmosphere, altitude_m: ArrayLike, mu: ArrayLike, hits_ground: ArrayLike
) -> FloatArray:
    """Distance (...,) in m to the ground; of rays that miss it, straight down.

    Where a ray misses, the formula for its mu may overflow, to no purpose.
    """
    return distance_to_ground(air.ground_radius_m, altitude_m, np.where(hits_ground, mu, -1.0))


def mu_of_ground_distance(
    air: Atmosphere, altitude_m: ArrayLike, distance_m: FloatArray
) -> FloatArray:
    """Cosine of the ray that meets the ground at a distance; of one with no length, down."""
    h, d = np.asarray(altitude_m, dtype=float), distance_m
    rho = tangent(air, h)
    return _cosine(-(rho * rho + d * d), (air.ground_radius_m + h) * d, none=-1.0)


def mu_of_top_distance(
    air: Atmosphere, altitude_m: ArrayLike, distance_m: FloatArray
) -> FloatArray:
    """Cosine of the ray that leaves the air at a distance; of one with no length, up."""
    h, d = np.asarray(altitude_m, dtype=float), distance_m
    ground, top = air.ground_radius_m, air.top_altitude_m
    rise = (top - h) * (2.0 * ground + top + h)
    return _cosine(rise - d * d, (ground + h) * d, none=1.0)


def _cosine(numerator: FloatArray, half_denominator: FloatArray, none: float) -> FloatArray:
    shape = np.broadcast(numerator, half_denominator).shape
    cosine = np.full(shape, none)
    np.divide(numerator, 2.0 * half_denominator, out=cosine, where=half_denominator > 0)
    return np.clip(cosine, -1.0, 1.0)

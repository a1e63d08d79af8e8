"""From points and directions about the planet's centre to the state that tables know."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import entry_to_air, make_ray
from bruneton_sky.tables.coordinates import State
from vrut_lite.arguments import as_vectors
from vrut_lite.numeric_types import FloatArray

_UNIT_SLACK = 1e-5
# Components beyond these have squares that are no numbers.
_LONGEST = 1e100
# Of points: beyond any planet's neighbourhood.
FARTHEST_M = 1e15


class View(NamedTuple):
    """What an observer looks at: the state where the ray is first inside the air.

    `entry_m` (...,) is the distance from the observer to there, 0 for one in the air; `misses`
    tells where there is no air on the ray at all.
    """

    state: State
    entry_m: FloatArray
    misses: NDArray[np.bool_]


def view_from(air: Atmosphere, camera: FloatArray, view: FloatArray, sun: FloatArray) -> View:
    """The view from points (..., 3) in m along unit vectors (..., 3).

    From outside, the ray's state at its entry is made from its distance to the planet's
    centre: it is as exact from the moon as from the top of the atmosphere.
    """
    top, top_radius = air.top_altitude_m, air.ground_radius_m + air.top_altitude_m
    radius = np.linalg.norm(camera, axis=-1)
    along = dot(camera, view)
    impact = np.linalg.norm(np.cross(camera, view), axis=-1)
    outside = radius > top_radius
    entry, mu, misses = entry_to_air(air.ground_radius_m, top, along, impact)
    misses &= outside
    entry = np.where(outside & ~misses, entry, 0.0)
    altitude = np.where(outside, top, np.maximum(radius - air.ground_radius_m, 0.0))
    mu = np.clip(np.where(outside, mu, along / radius), -1.0, 1.0)
    nu = np.clip(dot(view, sun), -1.0, 1.0)
    mu_s = (dot(camera, sun) + entry * nu) / np.where(outside, top_radius, radius)
    hits = make_ray(air.ground_radius_m, altitude, mu).hits_ground()
    state = State(altitude, mu, np.clip(mu_s, -1.0, 1.0), nu, hits)
    return View(state, entry, misses)


def level(air: Atmosphere, point: FloatArray, sun: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Altitude in m, held to the air, and the sun's mu_s at points (..., 3)."""
    radius = np.linalg.norm(point, axis=-1)
    altitude = np.clip(radius - air.ground_radius_m, 0.0, air.top_altitude_m)
    return altitude, np.clip(dot(point, sun) / radius, -1.0, 1.0)


def checked_point(name: str, value: ArrayLike, lowest_radius_m: float) -> FloatArray:
    """Points (..., 3) in m; refused where not finite or deeper than a millionth of the radius."""
    point = as_vectors(name, value, FARTHEST_M)
    radius_m = np.linalg.norm(point, axis=-1)
    if np.any(radius_m < lowest_radius_m * (1.0 - 1e-6)):
        raise ValueError(
            f"{name} must not lie below the ground, {lowest_radius_m:g} m from the centre: "
            f"not {float(np.min(radius_m)):g} m from there"
        )
    return point


def checked_direction(name: str, value: ArrayLike) -> FloatArray:
    """Unit vectors (..., 3), exact ones made of those that are nearly so."""
    direction = as_vectors(name, value, _LONGEST)
    length = np.linalg.norm(direction, axis=-1, keepdims=True)
    wrong = np.abs(length - 1.0) > _UNIT_SLACK
    if np.any(wrong):
        raise ValueError(f"{name} must be unit vectors, not {float(length[wrong][0]):g} long")
    return direction / length


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Scalar product (...,) of vectors (..., 3)."""
    return np.asarray((a * b).sum(axis=-1))

"""From points and directions about the planet's centre to the state that tables know."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import make_ray
from bruneton_sky.tables.coordinates import FloatArray, State

_UNIT_SLACK = 1e-5


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
    root = np.sqrt(np.maximum((top_radius - impact) * (top_radius + impact), 0.0))
    misses = outside & ((along >= 0) | (impact >= top_radius))
    entry = np.where(outside & ~misses, np.maximum(-along - root, 0.0), 0.0)
    altitude = np.where(outside, top, np.maximum(radius - air.ground_radius_m, 0.0))
    mu = np.clip(np.where(outside, -root / top_radius, along / radius), -1.0, 1.0)
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
    point = _vectors(name, value)
    if np.any(np.linalg.norm(point, axis=-1) < lowest_radius_m * (1.0 - 1e-6)):
        raise ValueError(
            f"{name} must not lie below the ground, {lowest_radius_m:g} m from the centre"
        )
    return point


def checked_direction(name: str, value: ArrayLike) -> FloatArray:
    """Unit vectors (..., 3), exact ones made of those that are nearly so."""
    direction = _vectors(name, value)
    length = np.linalg.norm(direction, axis=-1, keepdims=True)
    if np.any(np.abs(length - 1.0) > _UNIT_SLACK):
        raise ValueError(f"{name} must be unit vectors")
    return direction / length


def checked_number(name: str, value: ArrayLike, most: float = np.inf) -> FloatArray:
    """Numbers (...,) from 0 to `most`."""
    number = np.asarray(value, dtype=float)
    if not np.all(np.isfinite(number) & (number >= 0) & (number <= most)):
        limit = "not be negative" if most == np.inf else f"lie between 0 and {most:g}"
        raise ValueError(f"{name} must be finite and {limit}")
    return number


def _vectors(name: str, value: ArrayLike) -> FloatArray:
    vectors = np.asarray(value, dtype=float)
    if vectors.ndim == 0 or vectors.shape[-1] != 3 or not np.all(np.isfinite(vectors)):
        raise ValueError(f"{name} must be finite numbers of shape (..., 3)")
    return vectors


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Scalar product (...,) of vectors (..., 3)."""
    return np.asarray((a * b).sum(axis=-1))

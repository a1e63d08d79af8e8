"""Views and rays along them: entry into the air, length, states on the way."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import altitude_along, distance_to_top, entry_to_air, make_ray
from bruneton_sky.tables.parametrisations import State
from bruneton_sky.tables.ray_lengths import ground_distance
from vrut_lite.numeric_types import FloatArray


class ViewState(NamedTuple):
    """A view: the state where its ray is first inside the air.

    `entry_m` (...,) is the distance from the observer to there, 0 for one in the air; `misses`:
    whether the ray misses the air.
    """

    state: State
    entry_m: FloatArray
    misses: NDArray[np.bool_]


def view_from(air: Atmosphere, camera: FloatArray, view: FloatArray, sun: FloatArray) -> ViewState:
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
    return ViewState(state, entry, misses)


def level(air: Atmosphere, point: FloatArray, sun: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Altitude in m, held to the air, and the sun's mu_s at points (..., 3)."""
    radius = np.linalg.norm(point, axis=-1)
    altitude = np.clip(radius - air.ground_radius_m, 0.0, air.top_altitude_m)
    return altitude, np.clip(dot(point, sun) / radius, -1.0, 1.0)


def to_edge(air: Atmosphere, state: State) -> FloatArray:
    """Distance in m to where the view leaves the air or meets the ground."""
    down = ground_distance(air, state.altitude_m, state.mu, state.hits_ground)
    up = distance_to_top(air.ground_radius_m, air.top_altitude_m, state.altitude_m, state.mu)
    return np.where(state.hits_ground, down, up)


def moved(air: Atmosphere, state: State, distance_m: FloatArray) -> State:
    """The state after a distance along the view; whether that hits the ground stays."""
    altitude, mu = after(air, state.altitude_m, state.mu, distance_m)
    radius, there = air.ground_radius_m + state.altitude_m, air.ground_radius_m + altitude
    mu_s = (radius * state.mu_s + distance_m * state.nu) / there
    return State(altitude, mu, np.clip(mu_s, -1.0, 1.0), state.nu, state.hits_ground)


def after(
    air: Atmosphere, altitude_m: ArrayLike, mu: ArrayLike, distance_m: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Altitude in m, held to the air, and mu after a distance along a ray."""
    ground, d = air.ground_radius_m, np.asarray(distance_m, dtype=float)
    h, cosine = np.asarray(altitude_m, dtype=float), np.asarray(mu, dtype=float)
    there = np.clip(altitude_along(ground, h, cosine, d), 0.0, air.top_altitude_m)
    mu_there = ((ground + h) * cosine + d) / (ground + there)
    return there, np.clip(mu_there, -1.0, 1.0)


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Scalar product (...,) of vectors (..., 3)."""
    return np.asarray((a * b).sum(axis=-1))

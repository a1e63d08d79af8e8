"""Going along a view: how far it reaches, and the state after some way."""

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import altitude_along, distance_to_top
from bruneton_sky.tables.coordinates import State
from bruneton_sky.tables.ray_lengths import ground_distance
from vrut_lite.numeric_types import FloatArray


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

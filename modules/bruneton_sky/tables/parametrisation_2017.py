"""The scattering table's axes as in Bruneton's implementation of 2017.

They are those of the thesis's equations 2.31 to 2.37 (see `parametrisation_2008`) but for two:
mu is measured by the ray's length between the shortest and the longest there are at its
altitude, so that no node is wasted, and mu_s by the length of the sun's ray from the ground.

At altitude 0 rays to the ground have no length: their nodes all look straight down, and a
density of scattering looked up for level views close to the ground is partly that for down.
"""

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import distance_to_top
from bruneton_sky.tables import ray_lengths
from bruneton_sky.tables.coordinates import Coordinates, State, texture_coordinate, unit_range
from bruneton_sky.tables.sizes import TableSizes
from vrut_lite.numeric_types import FloatArray


def to_coordinates(atmosphere: Atmosphere, sizes: TableSizes, state: State) -> Coordinates:
    """The texture coordinates of states; each field has the shape of what it depends on."""
    air, half = atmosphere, sizes.mu // 2
    h = state.altitude_m
    to_ground = ray_lengths.ground_distance(air, h, state.mu, state.hits_ground)
    to_top = distance_to_top(air.ground_radius_m, air.top_altitude_m, h, state.mu)
    down = texture_coordinate(_share(to_ground, *ray_lengths.to_ground(air, h)), half)
    up = texture_coordinate(_share(to_top, *ray_lengths.to_top(air, h)), half)
    return Coordinates(
        texture_coordinate(ray_lengths.unit_of_altitude(air, h), sizes.altitude),
        np.where(state.hits_ground, 0.5 - 0.5 * down, 0.5 + 0.5 * up),
        texture_coordinate(0.5 * (1.0 + state.nu), sizes.nu),
        texture_coordinate(_unit_of_mu_s(air, state.mu_s), sizes.mu_s),
    )


def to_state(atmosphere: Atmosphere, sizes: TableSizes, coordinates: Coordinates) -> State:
    """The states at texture coordinates; nu is not yet held to what mu and mu_s allow."""
    air, half = atmosphere, sizes.mu // 2
    h = ray_lengths.altitude_of_unit(air, unit_range(coordinates.altitude, sizes.altitude))
    hits_ground = coordinates.mu < 0.5
    down = unit_range(1.0 - 2.0 * coordinates.mu, half)
    up = unit_range(2.0 * coordinates.mu - 1.0, half)
    mu_down = ray_lengths.mu_of_ground_distance(
        air, h, _length(down, *ray_lengths.to_ground(air, h))
    )
    mu_up = ray_lengths.mu_of_top_distance(air, h, _length(up, *ray_lengths.to_top(air, h)))
    return State(
        h,
        np.where(hits_ground, mu_down, mu_up),
        _mu_s_of_unit(air, unit_range(coordinates.mu_s, sizes.mu_s)),
        np.clip(2.0 * unit_range(coordinates.nu, sizes.nu) - 1.0, -1.0, 1.0),
        hits_ground,
    )


def _unit_of_mu_s(air: Atmosphere, mu_s: ArrayLike) -> FloatArray:
    """1 with the sun at the zenith, 0 with it at mu_s_min or below, steepest at the horizon."""
    a = _sun_share(air, mu_s)
    return np.maximum(1.0 - a / _sun_share(air, air.mu_s_min), 0.0) / (1.0 + a)


def _mu_s_of_unit(air: Atmosphere, unit: FloatArray) -> FloatArray:
    longest = _sun_share(air, air.mu_s_min)
    a = np.minimum(longest * (1.0 - unit) / (1.0 + unit * longest), longest)
    return ray_lengths.mu_of_top_distance(air, 0.0, _length(a, *ray_lengths.to_top(air, 0.0)))


def _sun_share(air: Atmosphere, mu_s: ArrayLike) -> FloatArray:
    """Length of the sun's ray to the ground: 0 from the zenith, 1 from the horizon."""
    length = distance_to_top(air.ground_radius_m, air.top_altitude_m, 0.0, mu_s)
    return _share(length, *ray_lengths.to_top(air, 0.0))


def _share(length: FloatArray, shortest: FloatArray, longest: FloatArray) -> FloatArray:
    """Place of a length between two; 0 where there is no room between them."""
    room = longest - shortest
    over = length - shortest
    shape = np.broadcast(over, room).shape
    return np.maximum(np.divide(over, room, out=np.zeros(shape), where=room > 0), 0.0)


def _length(share: FloatArray, shortest: FloatArray, longest: FloatArray) -> FloatArray:
    return shortest + share * (longest - shortest)

"""The scattering table's axes as published in 2008: the thesis's equations 2.31 to 2.37.

They come from Bruneton and Neyret 2008, section 4. The thesis prints three of them wrongly;
here the second case of 2.32 has the minus sign before its root, and 2.35 to 2.37 the lengths
rho = sqrt(r^2 - Rg^2), H = sqrt(Rt^2 - Rg^2) and Delta = r^2 mu^2 - rho^2. The axis of mu_s is
published for suns down to mu_s = -0.2 and is written here for any lowest sun.

Rays shorter than the shortest there is have coordinates too, and nodes there hold the shortest
ray's light. That is what the parametrisation of 2017 mends: between such a node and the next,
interpolation is off. Light scattered once, looked up in tables of the full sizes 1 km above
the ground with the sun at 37 to 87 deg, errs in views steeply down by 11 % in the mean (of
2017: 0.2 to 0.4 %), in views up by 0.3 to 0.7 % (0.2 to 0.5 %). With the sun 3 deg below the
horizon this axis of mu_s is the better one: 2 % on the ground against 6 %.
"""

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import distance_to_top
from bruneton_sky.tables import ray_lengths
from bruneton_sky.tables.coordinates import (
    Coordinates,
    State,
    texture_coordinate,
    unit_range,
)
from bruneton_sky.tables.sizes import TableSizes

_SUN_STEEPNESS = 3.0


def to_coordinates(atmosphere: Atmosphere, sizes: TableSizes, state: State) -> Coordinates:
    """The texture coordinates of states; each field has the shape of what it depends on."""
    air, half = atmosphere, sizes.mu // 2
    h = state.altitude_m
    longest_down, longest_up = ray_lengths.to_ground(air, h)[1], ray_lengths.to_top(air, h)[1]
    to_ground = ray_lengths.ground_distance(air, h, state.mu, state.hits_ground)
    to_top = distance_to_top(air.ground_radius_m, air.top_altitude_m, h, state.mu)
    shape = np.broadcast(to_ground, longest_down).shape
    down = np.divide(to_ground, longest_down, out=np.zeros(shape), where=longest_down > 0)
    span = 1.0 - np.exp(-_SUN_STEEPNESS * (1.0 - air.mu_s_min))
    sun = (1.0 - np.exp(-_SUN_STEEPNESS * (state.mu_s - air.mu_s_min))) / span
    return Coordinates(
        texture_coordinate(ray_lengths.unit_of_altitude(air, h), sizes.altitude),
        np.where(
            state.hits_ground,
            0.5 - 0.5 * texture_coordinate(down, half),
            0.5 + 0.5 * texture_coordinate(to_top / longest_up, half),
        ),
        texture_coordinate(0.5 * (1.0 + state.nu), sizes.nu),
        texture_coordinate(np.maximum(sun, 0.0), sizes.mu_s),
    )


def to_state(atmosphere: Atmosphere, sizes: TableSizes, coordinates: Coordinates) -> State:
    """The states at texture coordinates; nu is not yet held to what mu and mu_s allow."""
    air, half = atmosphere, sizes.mu // 2
    h = ray_lengths.altitude_of_unit(air, unit_range(coordinates.altitude, sizes.altitude))
    hits_ground = coordinates.mu < 0.5
    shortest, longest = ray_lengths.to_ground(air, h)
    down = np.maximum(unit_range(1.0 - 2.0 * coordinates.mu, half) * longest, shortest)
    shortest, longest = ray_lengths.to_top(air, h)
    up = np.maximum(unit_range(2.0 * coordinates.mu - 1.0, half) * longest, shortest)
    span = 1.0 - np.exp(-_SUN_STEEPNESS * (1.0 - air.mu_s_min))
    sun = unit_range(coordinates.mu_s, sizes.mu_s)
    return State(
        h,
        np.where(
            hits_ground,
            ray_lengths.mu_of_ground_distance(air, h, down),
            ray_lengths.mu_of_top_distance(air, h, up),
        ),
        np.clip(air.mu_s_min - np.log1p(-sun * span) / _SUN_STEEPNESS, -1.0, 1.0),
        np.clip(2.0 * unit_range(coordinates.nu, sizes.nu) - 1.0, -1.0, 1.0),
        hits_ground,
    )

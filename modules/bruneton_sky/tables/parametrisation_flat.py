"""The axes of the two flat tables: transmittance (altitude, mu) and irradiance (altitude, mu_s).

The thesis calls plain normalised axes sufficient for both. For the irradiance they are; the
transmittance falls to nothing within a degree of the horizon, which one node in 256 of a plain
axis would stand for, so it is measured by the ray's length, as Bruneton's implementation of
2017 does. Both parametrisations of the scattering tables use these.
"""

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import distance_to_top
from bruneton_sky.tables import ray_lengths
from bruneton_sky.tables.coordinates import texture_coordinate, unit_range
from vrut_lite.numeric_types import FloatArray


def transmittance_coordinates(
    atmosphere: Atmosphere, shape: tuple[int, ...], altitude_m: ArrayLike, mu: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Texture coordinates (altitude, mu) in a transmittance table of a shape."""
    air, h = atmosphere, np.asarray(altitude_m, dtype=float)
    length = distance_to_top(air.ground_radius_m, air.top_altitude_m, h, mu)
    shortest, longest = ray_lengths.to_top(air, h)
    return (
        texture_coordinate(ray_lengths.unit_of_altitude(air, h), shape[0]),
        texture_coordinate((length - shortest) / (longest - shortest), shape[1]),
    )


def transmittance_state(
    atmosphere: Atmosphere, shape: tuple[int, ...], altitude: ArrayLike, mu: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Altitude in m and mu at texture coordinates (altitude, mu)."""
    h = ray_lengths.altitude_of_unit(atmosphere, unit_range(altitude, shape[0]))
    shortest, longest = ray_lengths.to_top(atmosphere, h)
    length = shortest + unit_range(mu, shape[1]) * (longest - shortest)
    return h, ray_lengths.mu_of_top_distance(atmosphere, h, length)


def irradiance_coordinates(
    atmosphere: Atmosphere, shape: tuple[int, ...], altitude_m: ArrayLike, mu_s: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Texture coordinates (altitude, mu_s) in an irradiance table of a shape."""
    height = np.asarray(altitude_m, dtype=float) / atmosphere.top_altitude_m
    sun = 0.5 + 0.5 * np.asarray(mu_s, dtype=float)
    return texture_coordinate(height, shape[0]), texture_coordinate(sun, shape[1])


def irradiance_state(
    atmosphere: Atmosphere, shape: tuple[int, ...], altitude: ArrayLike, mu_s: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Altitude in m and mu_s at texture coordinates (altitude, mu_s)."""
    h = unit_range(altitude, shape[0]) * atmosphere.top_altitude_m
    return h, 2.0 * unit_range(mu_s, shape[1]) - 1.0

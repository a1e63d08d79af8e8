"""Looking up how much light a path through the air lets pass.

The table holds the transmittance to the top of the atmosphere; that between two points is a
ratio (thesis, equations 2.28 to 2.30). A ray that meets the ground is looked up backwards,
for the table knows no rays through the planet.
"""

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.tables.interpolate import interpolate
from bruneton_sky.tables.parametrisation_flat import transmittance_coordinates
from bruneton_sky.tables.travel import after
from vrut_lite.numeric_types import FloatArray


def transmittance_to_top(
    air: Atmosphere, table: FloatArray, altitude_m: ArrayLike, mu: ArrayLike
) -> FloatArray:
    """Transmittance (..., C) to the top of the atmosphere along a ray that misses the ground."""
    return interpolate(table, transmittance_coordinates(air, table.shape, altitude_m, mu))


def transmittance_between(
    air: Atmosphere,
    table: FloatArray,
    altitude_m: ArrayLike,
    mu: ArrayLike,
    distance_m: ArrayLike,
    hits_ground: ArrayLike,
) -> FloatArray:
    """Transmittance (..., C) along a ray's first metres, at most 1.

    It is 0 where both of the table's values underflow, in a haze no light crosses.
    """
    h, cosine = np.asarray(altitude_m, dtype=float), np.asarray(mu, dtype=float)
    there, mu_there = after(air, h, cosine, distance_m)
    back = np.where(hits_ground, -1.0, 1.0)
    near = transmittance_to_top(air, table, h, back * cosine)
    far = transmittance_to_top(air, table, there, back * mu_there)
    hits = np.asarray(hits_ground)[..., None]
    whole, rest = np.where(hits, far, near), np.where(hits, near, far)
    return np.minimum(np.divide(whole, rest, out=np.zeros_like(whole), where=rest > 0), 1.0)


def transmittance_to_sun(
    air: Atmosphere, table: FloatArray, altitude_m: ArrayLike, mu_s: ArrayLike
) -> FloatArray:
    """Transmittance (..., C) to the sun's disc, fading as the disc sinks below the horizon.

    The share of the disc that shows is a smooth step over its width (Bruneton 2017).
    """
    h, cosine = np.asarray(altitude_m, dtype=float), np.asarray(mu_s, dtype=float)
    ground = air.ground_radius_m
    half_width = air.sun_angular_radius_rad * ground / (ground + h)
    above = cosine - horizon_mu(ground, h)
    shown = smooth_step(-half_width, half_width, above)
    return transmittance_to_top(air, table, h, cosine) * shown[..., None]


def smooth_step(low: ArrayLike, high: ArrayLike, value: ArrayLike) -> FloatArray:
    """0 below `low`, 1 above `high`, a cubic between them."""
    start = np.asarray(low, dtype=float)
    t = np.clip((value - start) / (high - start), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))

"""The sky in any directions, such as a panorama's, by the tables of `sky_tables`."""

import math

import numpy as np
from numpy.typing import ArrayLike

from dynamic_skylight.hosek_wilkie.sky_tables import (
    BELOW_HORIZON,
    COMPILE,
    glow_place,
    sky_tables,
    zenith_place,
)
from dynamic_skylight.hosek_wilkie.texel_lanes import TEXELS, look_up_zenith, shade_texels
from vrut_lite.arguments import as_vectors
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.njit import njit
from vrut_lite.numeric_types import Float32Array, FloatArray

# Directions whose places are computed before they are looked up; a multiple of `TEXELS`.
_BLOCK = 256
_ZERO, _ONE = np.float32(0.0), np.float32(1.0)
# Beyond them the square of a length leaves single precision.
_LONGEST, _LEAST = 1e18, np.float32(1e-36)
_BELOW = np.int32(BELOW_HORIZON)
_GROUP, _COLOURS = np.uintp(TEXELS), np.uintp(3)


def radiance_towards(
    distribution: FloatArray,
    mean_radiance: FloatArray,
    sun_azimuth_rad: float,
    sun_elevation_rad: float,
    directions: ArrayLike,
) -> Float32Array:
    """See `HosekWilkieSky.radiance_towards`; the formula's numbers as `fill_cube` takes them."""
    towards = as_vectors("directions", directions, _LONGEST)
    single = np.ascontiguousarray(towards.reshape(-1, 3), np.float32)
    sun = world_from_enu(direction_from_angles(sun_azimuth_rad, sun_elevation_rad))
    # The last block is computed whole, and a pad follows it.
    blocks = -(-len(single) // _BLOCK)
    out = np.empty((blocks * _BLOCK + 1, 3), np.float32)
    tables = sky_tables(distribution, mean_radiance)
    if not _fill(single.reshape(-1), sun.astype(np.float32), *tables, out.reshape(-1)):
        raise ValueError("directions must be longer than 1e-18")
    return out[: len(single)].reshape(towards.shape)


@njit(**COMPILE)
def _fill(directions, sun, glow, zenith, out):  # type: ignore[no-untyped-def]
    """Whether all directions (3 n,) have a length; their radiance is in `out`, in blocks."""
    # Separate arrays: in rows of one the loop would not compile to vector code.
    glow_first, glow_share = np.zeros(_BLOCK, np.int32), np.zeros(_BLOCK, np.float32)
    zenith_first, zenith_share = np.zeros(_BLOCK, np.int32), np.zeros(_BLOCK, np.float32)
    factors, terms = np.zeros(4 * _BLOCK, np.float32), np.zeros(4 * _BLOCK, np.float32)
    toward_sun = (sun[0], sun[1], sun[2])
    total = directions.size // 3
    for block in range(0, total, _BLOCK):
        count = min(_BLOCK, total - block)
        shortest = _ONE
        for j in range(count):
            at = np.uintp(3) * (np.uintp(block) + np.uintp(j))
            dx, dy, dz = directions[at], directions[at + np.uintp(1)], directions[at + np.uintp(2)]
            squared = dx * dx + dy * dy + dz * dz
            shortest = min(shortest, squared)
            q = _ONE / math.sqrt(max(squared, _LEAST))
            first, share = glow_place(dx * q, dy * q, dz * q, toward_sun)
            glow_first[j], glow_share[j] = first, share
            first, share = zenith_place(max(dy * q, _ZERO))
            zenith_first[j] = first if dy >= _ZERO else _BELOW
            zenith_share[j] = share
        if shortest < _LEAST:
            return False
        for j in range(count):
            at = np.uintp(j)
            look_up_zenith(
                factors, terms, zenith, np.uintp(zenith_first[j]), zenith_share[j], at, at
            )
        for group in range((np.uintp(count) + _GROUP - np.uintp(1)) // _GROUP):
            at = group * _GROUP
            place = (np.uintp(block) + at) * _COLOURS
            shade_texels(out, place, glow, glow_first, glow_share, at, factors, terms)
    return True

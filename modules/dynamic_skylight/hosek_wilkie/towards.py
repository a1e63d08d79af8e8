"""The sky in any directions, such as a panorama's, by the tables of `sky_tables`."""

import math

import numpy as np
from numpy.typing import ArrayLike

from dynamic_skylight.hosek_wilkie.sky_tables import (
    BELOW_HORIZON,
    COEFFICIENT,
    COMPILE,
    GLOW_SCALE,
    ZENITH_SCALE,
    glow_piece,
    sky_tables,
    zenith_piece,
)
from dynamic_skylight.hosek_wilkie.texel_lanes import light_of_texel, zenith_of_texel
from vrut_lite.arguments import as_vectors
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.njit import njit
from vrut_lite.numeric_types import Float32Array, FloatArray

# Directions whose places are computed before they are looked up.
_BLOCK = 256
_ZERO, _ONE = np.float32(0.0), np.float32(1.0)
# Beyond them the square of a length leaves single precision.
_LONGEST, _LEAST = 1e18, np.float32(1e-36)
_BELOW = np.int32(BELOW_HORIZON)


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
    # A texel spoils the first number of the next.
    out = np.empty(single.size + 1, np.float32)
    tables = sky_tables(distribution, mean_radiance)
    # Separate arrays: in rows of one the loop would not compile to vector code.
    pieces = np.zeros(_BLOCK, np.int32), np.zeros(_BLOCK, np.int32)
    sizes = _BLOCK, _BLOCK, _BLOCK, COEFFICIENT * _BLOCK
    spaces = *pieces, *(np.zeros(size, np.float32) for size in sizes)
    toward_sun = sun.astype(np.float32)
    if not _fill(single.reshape(-1), toward_sun, tables, out, spaces):
        raise ValueError("directions must be longer than 1e-18")
    return out[:-1].reshape(towards.shape)


@njit(**COMPILE)
def _fill(directions, sun, tables, out, spaces):  # type: ignore[no-untyped-def]
    """Whether all directions (3 n,) have a length; their radiance is in `out` (3 n + 1,)."""
    glow, zenith, levels = tables
    glow_at, zenith_at, glow_place, zenith_place, root, factors = spaces
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
            first, start, chord, _ = glow_piece(dx * q, dy * q, dz * q, toward_sun)
            glow_at[j], glow_place[j] = first, start + chord * GLOW_SCALE
            root[j] = math.sqrt(max(dy * q, _ZERO))
            first, start = zenith_piece(root[j])
            zenith_at[j] = first if dy >= _ZERO else _BELOW
            zenith_place[j] = start + root[j] * ZENITH_SCALE
        if shortest < _LEAST:
            return False
        light = out[3 * block :]
        for j in range(count):
            at = np.uintp(j)
            zenith_of_texel(factors, zenith, np.uintp(zenith_at[j]), zenith_place[j], at, at)
            piece = np.uintp(glow_at[j])
            light_of_texel(light, glow, piece, glow_place[j], factors, root[j], levels, at)
    return True

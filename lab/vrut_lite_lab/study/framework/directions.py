"""The 81 directions in which skies are measured and compared.

A square grid of 9 x 9 points, folded onto the hemisphere by Shirley and Chiu's concentric map,
which keeps areas: the grid's square rings become circles of equal zenith angle. Direction
9 i + j belongs to the point (i, j); i counts towards north, j towards east.
"""

from functools import lru_cache

import numpy as np

from vrut_lite.numeric_types import FloatArray, IntArray

SIDE = 9
RINGS = 5
COUNT = SIDE * SIDE


@lru_cache(maxsize=1)
def directions() -> tuple[FloatArray, FloatArray]:
    """Zenith angle and azimuth (81,) in rad; azimuth from north, clockwise, in [0, 2 pi)."""
    across, along = np.divmod(np.arange(COUNT), SIDE)
    radius, azimuth = _concentric(2.0 * (across + 0.5) / SIDE - 1.0, 2.0 * (along + 0.5) / SIDE - 1)
    zenith = np.arccos(1.0 - radius**2)
    for angles in (zenith, azimuth):
        angles.flags.writeable = False
    return zenith, azimuth


@lru_cache(maxsize=1)
def ring_order() -> tuple[IntArray, ...]:
    """For each ring, from the zenith outwards, its directions by increasing azimuth from 0.

    Ring k > 0 has 8 k directions, 45 / k deg apart, the first due north.
    """
    _, azimuth = directions()
    ring = ring_of_direction()
    members = (np.flatnonzero(ring == k) for k in range(RINGS))
    return tuple(each[np.argsort(azimuth[each])] for each in members)


def ring_of_direction() -> IntArray:
    """The ring (81,) that each direction lies on, 0 at the zenith."""
    from_centre = np.abs(np.stack(np.divmod(np.arange(COUNT), SIDE)) - SIDE // 2)
    return np.asarray(from_centre.max(axis=0))


def ring_zenith_rad() -> FloatArray:
    """Zenith angle (5,) of each ring."""
    return np.arccos(1.0 - (2.0 * np.arange(RINGS) / SIDE) ** 2)


def _concentric(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Radius and angle of points of the square [-1, 1]^2 on the disc: Shirley and Chiu 1997."""
    along_a = np.abs(a) >= np.abs(b)
    major, minor = np.where(along_a, a, b), np.where(along_a, b, a)
    part = np.divide(minor, major, out=np.zeros_like(major), where=major != 0.0)
    angle = np.where(along_a, np.pi / 4 * part, np.pi / 2 - np.pi / 4 * part)
    # A point on the negative half of its axis lies half a turn from its mirror image.
    return np.abs(major), np.mod(angle + np.where(major < 0.0, np.pi, 0.0), 2.0 * np.pi)

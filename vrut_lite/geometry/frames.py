"""Frames of reference: sky-local axes (east, north, up) and glTF's world axes.

World: metres, right-handed, +Y up, east +X, north -Z. A place may turn north by an
offset: with `north_offset_rad` = a, true north lies at azimuth -a of the world's -Z axis,
that is, the scene's -Z points a clockwise of true north.
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray


def direction_from_angles(azimuth_rad: ArrayLike, elevation_rad: ArrayLike) -> FloatArray:
    """Unit vectors (..., 3) in east, north, up; azimuth from north, clockwise."""
    azimuth = np.asarray(azimuth_rad, dtype=float)
    elevation = np.asarray(elevation_rad, dtype=float)
    horizontal = np.cos(elevation)
    direction = np.empty((*np.broadcast_shapes(azimuth.shape, elevation.shape), 3))
    direction[..., 0] = horizontal * np.sin(azimuth)
    direction[..., 1] = horizontal * np.cos(azimuth)
    direction[..., 2] = np.sin(elevation)
    return direction


def angles_from_direction(direction: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Azimuth in [0, 2 pi) and elevation of vectors (..., 3) in east, north, up.

    arctan2 keeps full precision at the zenith, where arcsin(up) would lose half of it.
    """
    east, north, up = np.moveaxis(np.asarray(direction, dtype=float), -1, 0)
    azimuth = np.mod(np.arctan2(east, north), 2 * np.pi)
    # An azimuth just west of north rounds to a full turn.
    azimuth = np.where(azimuth < 2 * np.pi, azimuth, 0.0)
    return azimuth, np.arctan2(up, np.hypot(east, north))


def world_from_enu(direction: ArrayLike, north_offset_rad: float = 0.0) -> FloatArray:
    """World axes (x, y, z) of vectors (..., 3) given in east, north, up."""
    east, north, up = np.moveaxis(np.asarray(direction, dtype=float), -1, 0)
    c, s = np.cos(north_offset_rad), np.sin(north_offset_rad)
    return np.stack([c * east - s * north, up, -(s * east + c * north)], axis=-1)


def enu_from_world(direction: ArrayLike, north_offset_rad: float = 0.0) -> FloatArray:
    """East, north, up of vectors (..., 3) given in world axes; inverse of `world_from_enu`."""
    x, y, z = np.moveaxis(np.asarray(direction, dtype=float), -1, 0)
    c, s = np.cos(north_offset_rad), np.sin(north_offset_rad)
    return np.stack([c * x - s * z, -s * x - c * z, y], axis=-1)

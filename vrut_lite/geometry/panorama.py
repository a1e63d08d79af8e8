"""Panoramas: which direction each pixel of a latitude-longitude or fisheye picture sees."""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.frames import direction_from_angles, world_from_enu


def lat_long_directions(height: int, north_offset_rad: float = 0.0) -> NDArray[np.float64]:
    """World directions (height, 2 height, 3); north in the middle, zenith on the top row."""
    azimuth = ((np.arange(2 * height) + 0.5) / height - 1.0) * np.pi
    elevation = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
    enu = direction_from_angles(azimuth[None, :], elevation[:, None])
    return world_from_enu(enu, north_offset_rad)


def fisheye_directions(
    size: int, north_offset_rad: float = 0.0
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """World directions (size, size, 3) of an equidistant fisheye, and which pixels lie inside.

    Looking up with north at the top: east is on the left, as on a star chart.
    """
    c = (2.0 * np.arange(size) + 1.0) / size - 1.0
    right, up = np.meshgrid(c, -c)
    radius = np.hypot(right, up)
    azimuth = np.arctan2(-right, up)
    elevation = 0.5 * np.pi * (1.0 - np.minimum(radius, 1.0))
    enu = direction_from_angles(azimuth, elevation)
    return world_from_enu(enu, north_offset_rad), radius <= 1.0

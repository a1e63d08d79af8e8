"""Directions by angles."""

import numpy as np

from vrut_lite.geometry.frames import direction_from_angles, world_from_enu


def towards(elevation_deg: float, azimuth_deg: float = 0.0) -> np.ndarray:
    """The unit vector (3,), world axes; azimuth from north, clockwise."""
    return world_from_enu(direction_from_angles(*np.radians([azimuth_deg, elevation_deg])))

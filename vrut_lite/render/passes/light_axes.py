"""Axes and clip matrices of the sun's orthographic view."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def light_matrix(direction: ArrayLike, radius_m: float, depth_m: float) -> NDArray[np.float64]:
    """Clip matrix (4, 4) from a cylinder to [-1, 1]^3, of a sun in world `direction` (3,).

    Positions are relative to the cylinder's centre, in world axes; it reaches `depth_m` towards the
    sun and away. Shadows fall along the view direction, so a receiver outside has the x and y of
    its casters; only its depth exceeds 1, which the look-up clamps.
    """
    view = np.eye(4)
    view[:3, :3] = light_axes(direction)
    return np.diag([1.0 / radius_m, 1.0 / radius_m, -1.0 / depth_m, 1.0]) @ view


def light_axes(direction: ArrayLike) -> NDArray[np.float64]:
    """Rows right, up and towards the sun (3, 3)."""
    towards_sun = np.asarray(direction, dtype=float)
    towards_sun = towards_sun / np.linalg.norm(towards_sun)
    return np.array([*_perpendicular(towards_sun), towards_sun])


def _perpendicular(axis: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors that make a right-handed frame with any unit vector."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    right = np.cross(helper, axis)
    right /= np.linalg.norm(right)
    return right, np.cross(axis, right)

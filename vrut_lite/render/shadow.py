"""The sun's shadow maps: orthographic views from the sun, of the scene and of what is near.

In a scene of kilometres a texel of the one map is metres wide, and nothing of a person's size
casts a shadow in it. A second map then holds what is around the eye.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Half the width of the near map: its texels are then a hand's breadth.
NEAR_RADIUS_M = 400.0
# Of a scene that is not many times larger one map is enough.
_LARGE_RADII = 4.0
# The near map follows the eye in steps of so much of its radius. Its rim is faded over more.
_STEP = 1.0 / 64.0


def light_matrix(direction: ArrayLike, radius_m: float) -> NDArray[np.float64]:
    """Clip matrix (4, 4), a sphere to [-1, 1]^3, of a sun in world `direction` (3,).

    Positions count from the sphere's centre, in world axes. Shadows fall along the view
    direction, so what lies outside the scene's sphere is covered in x and y by whatever casts on
    it; only its depth exceeds 1, which the look-up clamps.
    """
    view = np.eye(4)
    view[:3, :3] = _light_axes(direction)
    return np.diag([1.0 / radius_m, 1.0 / radius_m, -1.0 / radius_m, 1.0]) @ view


def near_centre_m(
    eye_m: ArrayLike, direction: ArrayLike, scene_centre_m: ArrayLike, scene_radius_m: float
) -> NDArray[np.float64] | None:
    """Centre (3,) of the near map's sphere, None where the scene's own map is enough.

    It lies on a grid in the sun's axes, so that a step of the eye moves no texel to half its
    place, and most steps move none at all.
    """
    away_m = np.asarray(eye_m, dtype=float) - scene_centre_m
    large = scene_radius_m > _LARGE_RADII * NEAR_RADIUS_M
    if not large or np.linalg.norm(away_m) > scene_radius_m + NEAR_RADIUS_M:
        return None
    axes, step_m = _light_axes(direction), _STEP * NEAR_RADIUS_M
    return np.add(scene_centre_m, step_m * np.round(axes @ away_m / step_m) @ axes)


def _light_axes(direction: ArrayLike) -> NDArray[np.float64]:
    """Rows right, up and towards the sun (3, 3)."""
    towards_sun = np.asarray(direction, dtype=float)
    towards_sun = towards_sun / np.linalg.norm(towards_sun)
    return np.array([*_perpendicular(towards_sun), towards_sun])


def _perpendicular(axis: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors that make a right-handed frame with a unit vector, without a bad case."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    right = np.cross(helper, axis)
    right /= np.linalg.norm(right)
    return right, np.cross(axis, right)

"""The sun's shadow map: an orthographic view of the scene from the sun."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def light_matrix(direction: ArrayLike, radius_m: float) -> NDArray[np.float64]:
    """Clip matrix (4, 4), scene to [-1, 1]^3, of a sun in world `direction` (3,).

    Positions count from the scene's centre, in world axes; the box holds the sphere of the
    given radius around it. Shadows fall along the view
    direction, so what lies outside the sphere is covered in x and y by whatever casts on it;
    only its depth exceeds 1, which the look-up clamps.
    """
    towards_sun = np.asarray(direction, dtype=float)
    towards_sun = towards_sun / np.linalg.norm(towards_sun)
    right, up = _perpendicular(towards_sun)
    view = np.eye(4)
    view[:3, :3] = [right, up, towards_sun]
    return np.diag([1.0 / radius_m, 1.0 / radius_m, -1.0 / radius_m, 1.0]) @ view


def _perpendicular(axis: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors that make a right-handed frame with a unit vector, without a bad case."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    right = np.cross(helper, axis)
    right /= np.linalg.norm(right)
    return right, np.cross(axis, right)

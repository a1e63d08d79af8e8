"""Culling of spheres by a clip matrix."""

import numpy as np
from numpy.typing import NDArray


def reaches(clip: NDArray[np.float64], centre_m: NDArray[np.float64], radius_m: float) -> bool:
    """Whether a sphere may intersect the space between a matrix's (4, 4) side planes; conservative.

    The side planes of a perspective also exclude the space behind the eye.
    """
    planes = np.array([clip[3] + clip[0], clip[3] - clip[0], clip[3] + clip[1], clip[3] - clip[1]])
    planes /= np.linalg.norm(planes[:, :3], axis=1, keepdims=True)
    return bool(np.all(planes[:, :3] @ centre_m + planes[:, 3] >= -radius_m))


def bounds(
    clip: NDArray[np.float64], centre_m: NDArray[np.float64], radius_m: float
) -> NDArray[np.float64]:
    """Least and largest x and y (2, 2) of a sphere's points after division by w, within [-1, 1].

    Tangent planes through the eye bound the sphere; one that contains the eye fills everything.
    """
    whole = np.array([[-1.0, -1.0], [1.0, 1.0]])
    (nx, ny, _, nw), (px, py, _, pw) = clip[:, :3], clip[:, :3] @ centre_m + clip[:, 3]
    squared = pw * pw - radius_m**2 * float(nw @ nw)
    if pw <= 0.0 or squared <= 0.0:
        return whole
    found = np.empty((2, 2))
    for axis, (n, p) in enumerate(((nx, px), (ny, py))):
        middle = p * pw - radius_m**2 * float(n @ nw)
        beyond = p * p - radius_m**2 * float(n @ n)
        half = np.sqrt(max(middle * middle - squared * beyond, 0.0))
        found[:, axis] = (middle - half) / squared, (middle + half) / squared
    return np.clip(found, *whole)

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

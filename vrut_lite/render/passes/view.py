"""Matrices of a camera, and of placed meshes in its view."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class View:
    """A camera: the eye (3,), and matrices (4, 4) without the eye's translation."""

    eye_m: NDArray[np.float64]
    rotation: NDArray[np.float64]
    projection: NDArray[np.float64]

    @cached_property
    def clip_from_eye(self) -> NDArray[np.float64]:
        """Matrix (4, 4) of positions relative to the eye, in world axes."""
        return self.projection @ self.rotation

    def pixel_rad(self, size_px: tuple[int, int]) -> float:
        """Angle of a pixel in the middle of a picture (rad); 0 in parallel projection."""
        if self.projection[3, 3] != 0.0:
            return 0.0
        return 2.0 / (size_px[1] * float(self.projection[1, 1]))

    def shifted(self, shift_px: tuple[float, float], size_px: tuple[int, int]) -> "View":
        """The view shifted by pixels to the right and up."""
        projection = self.projection.copy()
        for axis in range(2):
            projection[axis] -= 2.0 * shift_px[axis] / size_px[axis] * projection[3]
        return replace(self, projection=projection)


def translation(offset_m: NDArray) -> NDArray[np.float64]:
    """Matrix (4, 4) that moves by an offset (3,)."""
    matrix = np.eye(4)
    matrix[:3, 3] = offset_m
    return matrix


def normal_matrix(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Matrix (3, 3) of normals where a matrix (4, 4) transforms positions.

    The cofactors, the inverse transpose times the determinant, are also valid under non-uniform
    scale, and where one axis is scaled to zero.
    """
    a, b, c = matrix[:3, :3].T.tolist()
    rows = np.array([_cross(b, c), _cross(c, a), _cross(a, b)])
    side = -1.0 if float(np.dot(a, rows[0])) < 0.0 else 1.0
    return side * rows.T


def _cross(a: list[float], b: list[float]) -> list[float]:
    """Cross product of two vectors; numpy takes ten times as long."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

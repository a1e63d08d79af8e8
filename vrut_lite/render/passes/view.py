"""A camera's matrices, and those of placed meshes as it sees them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class View:
    """A camera: the eye (3,), and matrices (4, 4) of its orientation alone."""

    eye_m: NDArray[np.float64]
    rotation: NDArray[np.float64]
    projection: NDArray[np.float64]

    @cached_property
    def clip_from_eye(self) -> NDArray[np.float64]:
        """Matrix (4, 4) of positions relative to the eye, in world axes."""
        return self.projection @ self.rotation


def translation(offset_m: NDArray) -> NDArray[np.float64]:
    """Matrix (4, 4) that moves by an offset (3,)."""
    matrix = np.eye(4)
    matrix[:3, 3] = offset_m
    return matrix


def normal_matrix(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Matrix (3, 3) of normals where positions go by a matrix (4, 4).

    The cofactors, the inverse transpose times the determinant: also under uneven scale, and where
    one axis is flattened to nothing.
    """
    m = matrix[:3, :3]
    side = -1.0 if np.linalg.det(m) < 0.0 else 1.0
    columns = [np.cross(m[:, (k + 1) % 3], m[:, (k + 2) % 3]) for k in range(3)]
    return side * np.stack(columns, axis=1)

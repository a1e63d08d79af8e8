"""Cells of surface orientation: an octahedron's square, cut evenly (Meyer et al. 2010)."""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import Float32Array, FloatArray

# Cells along an edge of the square; normals lie within 1.5 degrees of their cell's middle.
_EDGE = 64


def orientation_of(normal: Float32Array) -> NDArray[np.int32]:
    """The cell (N,) of normals (N, 3): "On floating-point normal vectors"."""
    n = normal / np.maximum(np.abs(normal).sum(axis=1, keepdims=True), 1e-9)
    x, z = n[:, 0], n[:, 2]
    below = n[:, 1] < 0.0
    folded_x = np.where(below, (1.0 - np.abs(z)) * np.where(x >= 0.0, 1.0, -1.0), x)
    folded_z = np.where(below, (1.0 - np.abs(x)) * np.where(z >= 0.0, 1.0, -1.0), z)
    cells = np.stack([folded_x, folded_z], axis=1) * 0.5 + 0.5
    column, row = np.clip((cells * _EDGE).astype(np.int32), 0, _EDGE - 1).T
    return np.asarray(row * _EDGE + column, np.int32)


def middle_normals() -> FloatArray:
    """Unit normals (cells, 3) at the middles of all cells."""
    middles = (np.arange(_EDGE) + 0.5) / _EDGE * 2.0 - 1.0
    z, x = np.meshgrid(middles, middles, indexing="ij")
    y = 1.0 - np.abs(x) - np.abs(z)
    fold = np.maximum(-y, 0.0)
    directions = np.stack(
        [x - np.where(x >= 0.0, fold, -fold), y, z - np.where(z >= 0.0, fold, -fold)], axis=-1
    ).reshape(-1, 3)
    return np.asarray(directions / np.linalg.norm(directions, axis=1, keepdims=True))

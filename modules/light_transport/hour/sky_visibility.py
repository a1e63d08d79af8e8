"""The irradiance of an open sky on surfaces of any orientation, by a table of orientations."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import hot
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.spherical_harmonics import basis
from vrut_lite.numeric_types import Float32Array, FloatArray

# Cells an edge of an octahedron's square: their middles lie within 1.5 degrees of all they hold.
_EDGE = 64


def orientation_of(normal: Float32Array) -> NDArray[np.int32]:
    """The cell (N,) of normals (N, 3): Meyer et al. 2010, "On floating-point normal vectors"."""
    n = normal / np.maximum(np.abs(normal).sum(axis=1, keepdims=True), 1e-9)
    x, z = n[:, 0], n[:, 2]
    below = n[:, 1] < 0.0
    folded_x = np.where(below, (1.0 - np.abs(z)) * np.where(x >= 0.0, 1.0, -1.0), x)
    folded_z = np.where(below, (1.0 - np.abs(x)) * np.where(z >= 0.0, 1.0, -1.0), z)
    cells = np.stack([folded_x, folded_z], axis=1) * 0.5 + 0.5
    column, row = np.clip((cells * _EDGE).astype(np.int32), 0, _EDGE - 1).T
    return np.asarray(row * _EDGE + column, np.int32)


def open_luminance(open_sky: FloatArray) -> Float32Array:
    """Luminance of irradiance (cells,) under open sky, by its harmonics (25, 3); above 0."""
    light = luminance(_basis() @ np.asarray(open_sky, np.float64))
    return np.maximum(light, 1e-30).astype(np.float32)


@hot
def scaled(light, factor, cell):  # type: ignore[no-untyped-def]
    """Multiply light (N, 4) by the factors (cells,) of its orientations (N,) or more."""
    for i in range(len(light)):
        for k in range(4):
            light[i, k] *= factor[cell[i]]


@hot
def to_shares(light, open_sky, cell):  # type: ignore[no-untyped-def]
    """Divide alpha of light (N, 4) by the luminance (cells,) of the open sky; at most 1."""
    for i in range(len(light)):
        share = light[i, 3] / open_sky[cell[i]]
        light[i, 3] = min(max(share, np.float32(0.0)), np.float32(1.0))


@lru_cache(maxsize=1)
def _basis() -> FloatArray:
    """Harmonics (cells, 25) at the middles of all cells."""
    middles = (np.arange(_EDGE) + 0.5) / _EDGE * 2.0 - 1.0
    z, x = np.meshgrid(middles, middles, indexing="ij")
    y = 1.0 - np.abs(x) - np.abs(z)
    fold = np.maximum(-y, 0.0)
    directions = np.stack(
        [x - np.where(x >= 0.0, fold, -fold), y, z - np.where(z >= 0.0, fold, -fold)], axis=-1
    ).reshape(-1, 3)
    return basis(directions / np.linalg.norm(directions, axis=1, keepdims=True))

"""Periodic Perlin and Worley noise from integer hashes, compiled.

Importing this module imports numba: do it only where clouds are made. The kernels release the GIL:
a layer takes a second, in which a window must not freeze.
"""

import math

import numpy as np
from numpy.typing import NDArray

from vrut_lite.njit import njit
from vrut_lite.numeric_types import FloatArray


@njit(cache=True, nogil=True)
def _mixed(x: int, y: int, z: int, seed: int) -> int:
    """A 32-bit hash of integer coordinates (Murmur's finaliser)."""
    mask = 0xFFFFFFFF
    h = (x * 0x8DA6B343 ^ y * 0xD8163841 ^ z * 0xCB1AB31F ^ seed * 0x165667B1) & mask
    h = ((h ^ (h >> 16)) * 0x85EBCA6B) & mask
    h = ((h ^ (h >> 13)) * 0xC2B2AE35) & mask
    return h ^ (h >> 16)


@njit(cache=True, nogil=True)
def feature_points(cells: int, seed: int) -> FloatArray:
    """One point in each cell (cells, cells, cells, 3), in units of cells, as z, y, x."""
    points = np.empty((cells, cells, cells, 3))
    for z in range(cells):
        for y in range(cells):
            for x in range(cells):
                for axis in range(3):
                    at = (z, y, x)[axis]
                    points[z, y, x, axis] = at + _mixed(x, y, z, 3 * seed + axis) / 4294967296.0
    return points


@njit(cache=True, nogil=True)
def _points_around(cells: int, seed: int) -> FloatArray:
    """The points (cells + 2, ...) of all cells and of those beyond each face, which repeat them."""
    points = feature_points(cells, seed)
    around = np.empty((cells + 2, cells + 2, cells + 2, 3))
    for z in range(-1, cells + 1):
        wz = z % cells
        for y in range(-1, cells + 1):
            wy = y % cells
            for x in range(-1, cells + 1):
                wx = x % cells
                around[z + 1, y + 1, x + 1, 0] = points[wz, wy, wx, 0] + (z - wz)
                around[z + 1, y + 1, x + 1, 1] = points[wz, wy, wx, 1] + (y - wy)
                around[z + 1, y + 1, x + 1, 2] = points[wz, wy, wx, 2] + (x - wx)
    return around


@njit(cache=True, nogil=True)
def worley(at: FloatArray, cells: int, seed: int) -> FloatArray:
    """1 - distance to the nearest point (n,), in cells, at places (n, 3) of period 1; [0, 1]."""
    points = _points_around(cells, seed)
    out = np.empty(len(at))
    for i in range(len(at)):
        z, y, x = at[i, 0] * cells, at[i, 1] * cells, at[i, 2] * cells
        iz, iy, ix = math.floor(z), math.floor(y), math.floor(x)
        wz, wy, wx = iz % cells, iy % cells, ix % cells
        z, y, x = z - (iz - wz), y - (iy - wy), x - (ix - wx)
        nearest = 9.0
        for cz in range(wz, wz + 3):
            for cy in range(wy, wy + 3):
                for cx in range(wx, wx + 3):
                    pz = points[cz, cy, cx, 0] - z
                    py = points[cz, cy, cx, 1] - y
                    px = points[cz, cy, cx, 2] - x
                    nearest = min(nearest, pz * pz + py * py + px * px)
        out[i] = max(1.0 - math.sqrt(nearest), 0.0)
    return out


@njit(cache=True, nogil=True)
def _gradients(cells: int, seed: int) -> NDArray[np.uint8]:
    """Which of Perlin's twelve gradients each lattice point has (cells + 1, ...), the period's end
    included."""
    chosen = np.empty((cells + 1, cells + 1, cells + 1), np.uint8)
    for z in range(cells + 1):
        for y in range(cells + 1):
            for x in range(cells + 1):
                chosen[z, y, x] = _mixed(x % cells, y % cells, z % cells, seed) % 12
    return chosen


@njit(cache=True, nogil=True)
def _pull(h: int, z: float, y: float, x: float) -> float:
    """The contribution of a lattice point with gradient `h`."""
    first = x if h < 8 else y
    second = y if h < 4 else z
    return (first if h & 1 == 0 else -first) + (second if h & 2 == 0 else -second)


@njit(cache=True, nogil=True)
def perlin(at: FloatArray, cells: int, seed: int) -> FloatArray:
    """Perlin's improved noise (2002) (n,), about [-1, 1], at places (n, 3) of period 1."""
    gradients = _gradients(cells, seed)
    out = np.empty(len(at))
    for i in range(len(at)):
        z, y, x = at[i, 0] * cells, at[i, 1] * cells, at[i, 2] * cells
        iz, iy, ix = math.floor(z), math.floor(y), math.floor(x)
        fz, fy, fx = z - iz, y - iy, x - ix
        wz, wy, wx = iz % cells, iy % cells, ix % cells
        sz = fz * fz * fz * (fz * (fz * 6.0 - 15.0) + 10.0)
        sy = fy * fy * fy * (fy * (fy * 6.0 - 15.0) + 10.0)
        sx = fx * fx * fx * (fx * (fx * 6.0 - 15.0) + 10.0)
        total = 0.0
        for dz in range(2):
            for dy in range(2):
                for dx in range(2):
                    weight = (
                        (sz if dz else 1.0 - sz)
                        * (sy if dy else 1.0 - sy)
                        * (sx if dx else 1.0 - sx)
                    )
                    h = gradients[wz + dz, wy + dy, wx + dx]
                    total += weight * _pull(h, fz - dz, fy - dy, fx - dx)
        out[i] = total
    return out

"""Cube maps in OpenGL's face order and orientation, in world axes.

Faces: +X -X +Y -Y +Z -Z. Row 0 is t = 0, the first row of the image that OpenGL takes.
Texel centres sit at a = (2 j + 1) / size - 1 along s and b likewise along t; a face's
direction is normal + a * s_axis + b * t_axis (OpenGL 4.6 specification, table 8.19).
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

FACES = ("+X", "-X", "+Y", "-Y", "+Z", "-Z")
FACE_NORMALS = np.array(
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=float
)
FACE_S_AXES = np.array(
    [[0, 0, -1], [0, 0, 1], [1, 0, 0], [1, 0, 0], [1, 0, 0], [-1, 0, 0]], dtype=float
)
FACE_T_AXES = np.array(
    [[0, -1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1], [0, -1, 0], [0, -1, 0]], dtype=float
)


def texel_centres(size: int) -> NDArray[np.float64]:
    """Face coordinates (size,) of the texel centres, in (-1, 1)."""
    return (2.0 * np.arange(size) + 1.0) / size - 1.0


@lru_cache(maxsize=8)
def texel_directions(size: int) -> NDArray[np.float64]:
    """Unit world directions (6, size, size, 3) of the texel centres; read-only."""
    c = texel_centres(size)
    a, b = c[None, None, :, None], c[None, :, None, None]
    d = (
        FACE_NORMALS[:, None, None, :]
        + a * FACE_S_AXES[:, None, None, :]
        + b * FACE_T_AXES[:, None, None, :]
    )
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    d.flags.writeable = False
    return d


@lru_cache(maxsize=8)
def texel_solid_angles(size: int) -> NDArray[np.float64]:
    """Exact solid angles (size, size) of one face's texels, in sr; they sum to 2 pi / 3.

    The corner function atan(x y / sqrt(x^2 + y^2 + 1)) integrates 1 / (1 + x^2 + y^2)^1.5.
    """
    edges = 2.0 * np.arange(size + 1) / size - 1.0
    x, y = edges[None, :], edges[:, None]
    corner = np.arctan2(x * y, np.sqrt(x * x + y * y + 1.0))
    omega = corner[1:, 1:] - corner[:-1, 1:] - corner[1:, :-1] + corner[:-1, :-1]
    omega.flags.writeable = False
    return omega


def reduce_cube(cube: NDArray[np.floating], size: int) -> NDArray[np.float64]:
    """Average a cube (6, n, n, C) down to about `size` texels an edge, by exact solid angle.

    Blocks are whole: the result has n / k texels an edge, with k the largest divisor of n
    that leaves at least `size`.
    """
    n = cube.shape[1]
    k = max(1, n // size)
    while n % k:
        k -= 1
    if k == 1:
        return np.array(cube, dtype=np.float64)
    m = n // k
    omega = texel_solid_angles(n)
    weighted = np.asarray(cube, dtype=np.float64) * omega[None, :, :, None]
    blocks = weighted.reshape(6, m, k, m, k, -1).sum(axis=(2, 4))
    return blocks / omega.reshape(m, k, m, k).sum(axis=(1, 3))[None, :, :, None]


def sample_cube(cube: NDArray[np.floating], direction: NDArray[np.floating]) -> NDArray[np.float64]:
    """Bilinear look-up (..., 3) of a cube (6, n, n, 3) at world directions (..., 3).

    It interpolates within a face only: the half texel at a face's edge repeats its neighbour,
    as in a GL cube map without seamless filtering. For panoramas, not for lighting.
    """
    d = np.asarray(direction, dtype=np.float64)
    n = cube.shape[1]
    face = major_face(d)
    major = np.einsum("...i,...i->...", d, FACE_NORMALS[face])
    a = np.einsum("...i,...i->...", d, FACE_S_AXES[face]) / major
    b = np.einsum("...i,...i->...", d, FACE_T_AXES[face]) / major
    col = np.clip((a + 1.0) * 0.5 * n - 0.5, 0.0, n - 1.0)
    row = np.clip((b + 1.0) * 0.5 * n - 0.5, 0.0, n - 1.0)
    j0, i0 = np.minimum(col.astype(int), n - 2), np.minimum(row.astype(int), n - 2)
    u, v = (col - j0)[..., None], (row - i0)[..., None]
    top = cube[face, i0, j0] * (1 - u) + cube[face, i0, j0 + 1] * u
    bottom = cube[face, i0 + 1, j0] * (1 - u) + cube[face, i0 + 1, j0 + 1] * u
    return np.asarray(top * (1 - v) + bottom * v, dtype=np.float64)


def major_face(d: NDArray[np.float64]) -> NDArray[np.intp]:
    """Index (...,) of the cube face whose axis is the largest component of d (..., 3)."""
    axis = np.argmax(np.abs(d), axis=-1)
    negative = np.take_along_axis(d, axis[..., None], axis=-1)[..., 0] < 0
    return 2 * axis + negative

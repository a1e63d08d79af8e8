"""Divides the sky into cells, smallest at the horizon, and open ground into coarser ones.

Shirley and Chiu's concentric map (1997) lays a square of 24 x 24 cells on a disc, and the disc lies
on the upper hemisphere: the radius r belongs to directions whose height has the sine

    y = (1 - r^2) (1 - _STEEPNESS r^2).

Solid angles are 1.7 of the mean at the zenith and 0.3 at the horizon, where fog and haze are steep.
The lowest rows are 3.8, 5.3 and 6.3 degrees high; cells of equal solid angle would be 9.2 there.
The lower hemisphere has 36 cells of the same kind. All ground is equally bright: its cells give the
direction in which it is seen.
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from light_transport.kernels import kernel
from vrut_lite.geometry import cube_map
from vrut_lite.geometry.cached_table import kept_table
from vrut_lite.geometry.cube_map import (
    FACE_NORMALS,
    FACE_S_AXES,
    FACE_T_AXES,
    reduce_cube,
    texel_directions,
    texel_solid_angles,
)
from vrut_lite.numeric_types import FloatArray

EDGE, GROUND_EDGE = 24, 6
_STEEPNESS = 0.7
# The first of the ground's.
GROUND_NODE = EDGE * EDGE
NODES = GROUND_NODE + GROUND_EDGE * GROUND_EDGE
# A cube map is averaged to about this many texels an edge before.
_CUBE_TEXELS = 64
# Each cell holds dozens of texels of such a cube map.
_FINE_TEXELS = 128
# Texels are cut into so many pieces an edge, each of which lies in one cell.
_PIECES = 6


@kernel
def node_of(x, y, z):  # type: ignore[no-untyped-def]
    """The cell of a unit vector; below the horizon one of open ground."""
    edge, first = (EDGE, 0) if y >= 0.0 else (GROUND_EDGE, GROUND_NODE)
    half = 0.5 * (1.0 + _STEEPNESS)
    root = math.sqrt(half * half - _STEEPNESS * max(0.0, 1.0 - abs(y)))
    radius = math.sqrt(max(0.0, half - root) / _STEEPNESS)
    quarter = 0.25 * math.pi
    angle = math.atan2(z, x)
    if angle < -quarter:
        angle += 2.0 * math.pi
    if angle < quarter:
        a = radius
        b = angle * a / quarter
    elif angle < 3.0 * quarter:
        b = radius
        a = -(angle - 2.0 * quarter) * b / quarter
    elif angle < 5.0 * quarter:
        a = -radius
        b = (angle - 4.0 * quarter) * a / quarter
    else:
        b = -radius
        a = -(angle - 6.0 * quarter) * b / quarter
    row = min(int(0.5 * (a + 1.0) * edge), edge - 1)
    column = min(int(0.5 * (b + 1.0) * edge), edge - 1)
    return first + row * edge + column


def sine_of_height(radius2: FloatArray) -> FloatArray:
    """Sine of the height of directions at squares of the disc's radius, 0 to 1."""
    return (1.0 - radius2) * (1.0 - _STEEPNESS * radius2)


def disc_radius(sine: FloatArray) -> FloatArray:
    """Radius on the disc, 0 to 1, of directions whose height has a sine, 0 to 1."""
    half = 0.5 * (1.0 + _STEEPNESS)
    root = np.sqrt(half * half - _STEEPNESS * np.maximum(1.0 - sine, 0.0))
    return np.asarray(np.sqrt(np.maximum(half - root, 0.0) / _STEEPNESS))


def relative_solid_angle(radius2: FloatArray) -> FloatArray:
    """Solid angle of an element of the disc, over the mean, at squares of the radius."""
    return 1.0 + _STEEPNESS * (1.0 - 2.0 * radius2)


def node_radiances(sky: NDArray[np.floating], ground_radiance_rgb: ArrayLike) -> FloatArray:
    """Mean radiance (NODES, 3) of each cell of a cube map (6, n, n, 3), open ground last."""
    cube = reduce_cube(sky, _CUBE_TEXELS)
    node, texel, weight = _shares(cube.shape[1])
    flat = cube.reshape(-1, 3)
    means = np.empty((NODES, 3))
    for channel in range(3):
        total = np.bincount(node, weight * flat[texel, channel], GROUND_NODE)
        means[:GROUND_NODE, channel] = total
    means[GROUND_NODE:] = ground_radiance_rgb
    return means


@lru_cache(maxsize=1)
def node_directions() -> FloatArray:
    """Unit vectors (NODES, 3) to the mean of each cell's directions."""
    directions = texel_directions(_FINE_TEXELS).reshape(-1, 3)
    weight = np.tile(texel_solid_angles(_FINE_TEXELS).ravel(), 6)
    node = _nodes_of(directions)
    sums = [np.bincount(node, weight * directions[:, axis], NODES) for axis in range(3)]
    found = np.stack(sums, axis=1)
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


@lru_cache(maxsize=2)
def _shares(size: int) -> tuple[NDArray[np.int64], NDArray[np.int64], FloatArray]:
    """Cells, texels of a cube map and weights (K,): a cell's mean is the weighted sum of texels."""
    name, sources = f"sky nodes {size}", (__file__, cube_map.__file__)
    table = kept_table(name, lambda: _shares_table(size), *sources)
    return table[0].astype(np.int64), table[1].astype(np.int64), table[2]


def _shares_table(size: int) -> FloatArray:
    """The three (3, K)."""
    fine = size * _PIECES
    c = (2.0 * np.arange(fine) + 1.0) / fine - 1.0
    a, b = c[None, None, :, None], c[None, :, None, None]
    d = (
        FACE_NORMALS[:, None, None]
        + a * FACE_S_AXES[:, None, None]
        + b * FACE_T_AXES[:, None, None]
    )
    above = d[..., 1] >= 0.0
    d = d[above]
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    solid_angle = np.broadcast_to(texel_solid_angles(fine), above.shape)[above]
    row, column = np.indices((fine, fine)) // _PIECES
    texel = (np.arange(6)[:, None, None] * size * size + row * size + column)[above]
    # Pieces of one texel in one cell are one.
    key = _nodes_of(d) * np.int64(6 * size * size) + texel
    keys, where = np.unique(key, return_inverse=True)
    weight = np.bincount(where.ravel(), solid_angle)
    node, texel = keys // (6 * size * size), keys % (6 * size * size)
    share = weight / np.bincount(node, weight, GROUND_NODE)[node]
    return np.stack([node, texel, share])


@kernel
def _nodes_of(directions):  # type: ignore[no-untyped-def]
    node = np.empty(len(directions), np.int64)
    for i in range(len(directions)):
        node[i] = node_of(directions[i, 0], directions[i, 1], directions[i, 2])
    return node

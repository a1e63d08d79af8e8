"""Cells over the upper hemisphere, finer than those of the ray table.

The map of `light_transport.rays.sky_nodes`: each cell of the table's sky is FINER x FINER cells
here. Their solid angles fall from 1.7 of the mean at the zenith to 0.3 at the horizon.
"""

from functools import lru_cache

import numpy as np
from light_transport.public import EDGE as NODE_EDGE
from light_transport.public import (
    GROUND_NODE,
    disc_radius,
    relative_solid_angle,
    sine_of_height,
)
from numpy.typing import NDArray

from vrut_lite.geometry.cube_map import sample_cube
from vrut_lite.numeric_types import FloatArray

FINER = 4
EDGE = NODE_EDGE * FINER
CELLS = EDGE * EDGE
# Directions along each edge of a cell at which a sky is looked up.
_LOOKS = 2
# Points along each edge of a cell at which its solid angle is summed.
_POINTS = 8


def cell_of(directions: FloatArray) -> NDArray[np.int32]:
    """Cells (R,) of unit vectors (R, 3) above the horizon."""
    x, y, z = np.moveaxis(np.asarray(directions, float), -1, 0)
    radius = disc_radius(np.abs(y))
    level = np.maximum(np.hypot(x, z), 1e-30)
    x, z = radius * x / level, radius * z / level
    eighth = np.pi / 4.0
    along_x = np.abs(x) >= np.abs(z)
    with np.errstate(divide="ignore", invalid="ignore"):
        a = np.where(along_x, np.sign(x) * radius, radius * np.arctan(x / np.abs(z)) / eighth)
        b = np.where(along_x, radius * np.arctan(z / np.abs(x)) / eighth, np.sign(z) * radius)
    row = np.clip((0.5 * (np.nan_to_num(a) + 1.0) * EDGE).astype(np.int64), 0, EDGE - 1)
    column = np.clip((0.5 * (np.nan_to_num(b) + 1.0) * EDGE).astype(np.int64), 0, EDGE - 1)
    return (row * EDGE + column).astype(np.int32)


def on_disc(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points of the unit disc by Shirley and Chiu's map of the square [-1, 1] x [-1, 1]."""
    eighth = np.pi / 4.0
    along_a = np.abs(a) >= np.abs(b)
    radius = np.where(along_a, a, b)
    quotient = np.where(along_a, b, a) / np.where(radius == 0.0, 1.0, radius)
    angle = np.where(along_a, eighth * quotient, 2.0 * eighth - eighth * quotient)
    return radius * np.cos(angle), radius * np.sin(angle)


def directions_at(a: FloatArray, b: FloatArray) -> FloatArray:
    """Unit vectors (..., 3) at points (...) of the square [-1, 1] x [-1, 1], rows and columns."""
    x, z = on_disc(a, b)
    radius2 = x * x + z * z
    sine = sine_of_height(radius2)
    level = np.sqrt(np.maximum(1.0 - sine * sine, 0.0) / np.maximum(radius2, 1e-30))
    return np.stack([x * level, sine, z * level], axis=-1)


@lru_cache(maxsize=1)
def cell_directions() -> FloatArray:
    """Unit vectors (CELLS, _LOOKS^2, 3) spread over each cell."""
    directions = directions_at(*_points(_LOOKS))
    blocks = directions.reshape(EDGE, _LOOKS, EDGE, _LOOKS, 3).swapaxes(1, 2)
    return blocks.reshape(CELLS, _LOOKS * _LOOKS, 3)


@lru_cache(maxsize=1)
def cell_solid_angles() -> FloatArray:
    """Solid angles (CELLS,) in sr; their sum is that of the hemisphere."""
    radius = np.max(np.abs(_points(_POINTS)), axis=0)
    share = relative_solid_angle(radius * radius).reshape(EDGE, _POINTS, EDGE, _POINTS)
    return np.asarray(2.0 * np.pi * share.mean(axis=(1, 3)).ravel() / share.sum() * _POINTS**2)


@lru_cache(maxsize=1)
def cell_weights() -> FloatArray:
    """Solid angles (CELLS,) in sr, weighted by the sine of height: irradiance of level ground."""
    return cell_solid_angles() * cell_directions()[..., 1].mean(axis=1)


def cell_radiances(cube: NDArray[np.floating]) -> FloatArray:
    """Mean radiance (CELLS, 3) of each cell of a sky's cube map (6, n, n, 3)."""
    return np.asarray(sample_cube(cube, cell_directions()).mean(axis=1))


@lru_cache(maxsize=1)
def node_of_cell() -> NDArray[np.int64]:
    """The ray table's node (CELLS,) that each cell is a part of."""
    row, column = np.divmod(np.arange(CELLS), EDGE)
    return row // FINER * NODE_EDGE + column // FINER


@lru_cache(maxsize=1)
def node_weights() -> FloatArray:
    """Solid angles (GROUND_NODE,) of nodes in sr, weighted by the sine of height."""
    return np.asarray(np.bincount(node_of_cell(), cell_weights()), float)


def node_means(values: FloatArray) -> FloatArray:
    """Means (GROUND_NODE, W) over each of the ray table's nodes of values (CELLS, W) of cells."""
    node, solid = node_of_cell(), cell_solid_angles()
    sums = [np.bincount(node, solid * column, GROUND_NODE) for column in values.T]
    return np.stack(sums, axis=1) / np.bincount(node, solid)[:, None]


def _points(per_cell: int) -> tuple[FloatArray, FloatArray]:
    """Rows and columns (n, n) of the square at so many points along each edge of a cell."""
    count = EDGE * per_cell
    middle = (2.0 * np.arange(count) + 1.0) / count - 1.0
    a, b = np.meshgrid(middle, middle, indexing="ij")
    return a, b

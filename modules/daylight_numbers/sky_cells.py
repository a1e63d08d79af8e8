"""Cells of equal solid angle over the upper hemisphere, finer than those of the ray table.

Shirley and Chiu's concentric map (1997), as in `rays.sky_nodes`: each cell of the table's sky is
FINER x FINER cells here.
"""

from functools import lru_cache

import numpy as np
from light_transport.public import EDGE as NODE_EDGE
from numpy.typing import NDArray

from vrut_lite.geometry.cube_map import sample_cube
from vrut_lite.numeric_types import FloatArray

FINER = 4
EDGE = NODE_EDGE * FINER
CELLS = EDGE * EDGE
CELL_SR = 2.0 * np.pi / CELLS
# Directions along each edge of a cell at which a sky is looked up.
_LOOKS = 2


def cell_of(directions: FloatArray) -> NDArray[np.int32]:
    """Cells (R,) of unit vectors (R, 3) above the horizon."""
    x, y, z = np.moveaxis(np.asarray(directions, float), -1, 0)
    radius = np.sqrt(np.maximum(1.0 - np.abs(y), 0.0))
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


@lru_cache(maxsize=1)
def cell_directions() -> FloatArray:
    """Unit vectors (CELLS, _LOOKS^2, 3) spread over each cell."""
    fine = EDGE * _LOOKS
    middle = (2.0 * np.arange(fine) + 1.0) / fine - 1.0
    a, b = np.meshgrid(middle, middle, indexing="ij")
    x, z = on_disc(a, b)
    radius2 = x * x + z * z
    level = np.sqrt(np.maximum(2.0 - radius2, 0.0))
    directions = np.stack([x * level, 1.0 - radius2, z * level], axis=-1)
    blocks = directions.reshape(EDGE, _LOOKS, EDGE, _LOOKS, 3).swapaxes(1, 2)
    return blocks.reshape(CELLS, _LOOKS * _LOOKS, 3)


def cell_radiances(cube: NDArray[np.floating]) -> FloatArray:
    """Mean radiance (CELLS, 3) of each cell of a sky's cube map (6, n, n, 3)."""
    return np.asarray(sample_cube(cube, cell_directions()).mean(axis=1))


@lru_cache(maxsize=1)
def node_of_cell() -> NDArray[np.int64]:
    """The ray table's node (CELLS,) that each cell is a part of."""
    row, column = np.divmod(np.arange(CELLS), EDGE)
    return row // FINER * NODE_EDGE + column // FINER

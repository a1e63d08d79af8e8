"""Linear interpolation between the nodes of a table of any number of axes."""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray


def interpolate(table: FloatArray, coordinates: Sequence[FloatArray]) -> FloatArray:
    """Values (..., C) of a table (n1, ..., nk, C) at k texture coordinates that broadcast.

    As a GPU samples a texture: nodes are texel centres, and beyond the outermost of them the
    value stays. The four-linear look-up that a GPU cannot do is the same with k = 4.
    """
    *sizes, channels = table.shape
    nodes = table.reshape(-1, channels)
    shape = np.broadcast_shapes(*(np.shape(c) for c in coordinates))
    values = np.zeros((*shape, channels))
    for index, weight in _corners(tuple(sizes), coordinates):
        values += weight[..., None] * nodes[index]
    return values


def neighbours(coordinate: FloatArray, size: int) -> tuple[NDArray[np.intp], FloatArray]:
    """Index of the node before a texture coordinate, not the last, and the share of the next."""
    position = np.clip(np.asarray(coordinate) * size - 0.5, 0.0, size - 1.0)
    before = np.minimum(position.astype(np.intp), size - 2)
    return before, position - before


def _corners(
    sizes: tuple[int, ...], coordinates: Sequence[FloatArray]
) -> Iterator[tuple[NDArray[np.intp], FloatArray]]:
    """Flat index and weight of each of the 2^k nodes around."""
    sides = []
    strides = np.cumprod((1, *sizes[:0:-1]))[::-1]
    for coordinate, size, stride in zip(coordinates, sizes, strides, strict=True):
        before, share = neighbours(coordinate, size)
        sides.append(((before * stride, 1.0 - share), ((before + 1) * stride, share)))
    for corner in product(*sides):
        index, weight = corner[0]
        for step, factor in corner[1:]:
            index, weight = index + step, weight * factor
        yield index, weight

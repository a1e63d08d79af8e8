"""Interpolation between the nodes of a table: linear, or by cubics along the sun's axis."""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray


def interpolate(table: FloatArray, coordinates: Sequence[FloatArray]) -> FloatArray:
    """Values (..., C) of a table (n1, ..., nk, C) at k texture coordinates that broadcast.

    As a GPU samples a texture, for any k: nodes are texel centres, and beyond the outermost of
    them the value stays.
    """
    *sizes, channels = table.shape
    nodes = table.reshape(-1, channels)
    shape = np.broadcast_shapes(*(np.shape(c) for c in coordinates))
    values = np.zeros((*shape, channels))
    for index, weight in _corners(tuple(sizes), coordinates):
        values += weight[..., None] * nodes[index]
    return values


def interpolate_suns(
    tables: Sequence[FloatArray], coordinates: Sequence[FloatArray]
) -> tuple[FloatArray, ...]:
    """Values (..., C) of tables (n1, ..., nk, C) of one shape, by cubics along axis k, the sun's.

    Otherwise as `interpolate`.

    The tables hold nothing negative. Cubics are Hermite's with Catmull and Rom's slopes, limited as
    by Fritsch and Carlson 1980: between two nodes no value is above or below both, so that
    radiance is never negative and does not swing where the sun sets. In twilight lines between the
    nodes would be the tables' largest error.
    """
    *others, suns = coordinates
    size = tables[0].shape[-2]
    before, share = neighbours(suns, size)
    first = np.clip(before - 1, 0, size - 4)
    shape = np.broadcast_shapes(*(np.shape(c) for c in coordinates))
    corners = list(_corners(tables[0].shape[:-2], others))
    return tuple(
        _cubic(_four_suns(table, shape, corners, first), before - first, share) for table in tables
    )


def _four_suns(
    table: FloatArray,
    shape: tuple[int, ...],
    corners: Sequence[tuple[NDArray[np.intp], FloatArray]],
    first: NDArray[np.intp],
) -> FloatArray:
    """Values (..., 4, C) at four suns from `first` on, which lie side by side in memory."""
    size, channels = table.shape[-2:]
    runs = sliding_window_view(np.ascontiguousarray(table).reshape(-1), 4 * channels)[::channels]
    values = np.zeros((*shape, 4 * channels))
    for index, weight in corners:
        values += weight[..., None] * runs[index * size + first]
    return values.reshape(*shape, 4, channels)


def _cubic(values: FloatArray, interval: NDArray[np.intp], share: FloatArray) -> FloatArray:
    """Values (..., C) at a share (...,) of one of the three intervals between four (..., 4, C).

    It is the middle one but at the ends of the axis, where differences go on as a line.
    """
    d0, d1, d2 = np.moveaxis(np.diff(values, axis=-2), -2, 0)
    t, at = share[..., None], interval[..., None]
    start = np.take_along_axis(
        values, np.broadcast_to(at[..., None], (*values.shape[:-2], 1, 1)), axis=-2
    )[..., 0, :]
    if np.all(interval == 1):
        left, middle, right = d0, d1, d2
    else:
        left = np.choose(at, (2.0 * d0 - d1, d0, d1))
        middle = np.choose(at, (d0, d1, d2))
        right = np.choose(at, (d1, d2, 2.0 * d2 - d1))
    near, far = _limited_slope(left, middle), _limited_slope(middle, right)
    bend = 3.0 * middle - 2.0 * near - far
    value = start + t * (near + t * (bend + t * (near + far - 2.0 * middle)))
    # Beside a node that is 0, rounding may fall below.
    return np.maximum(value, 0.0)


def _limited_slope(left: FloatArray, right: FloatArray) -> FloatArray:
    """Slope at a node between two differences: 0 where they part in sign."""
    most = 3.0 * np.minimum(np.abs(left), np.abs(right))
    return np.where(left * right > 0.0, np.clip(0.5 * (left + right), -most, most), 0.0)


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

"""Triangles without texels that share one value of light, those of sheets on either side."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.rays.map_texels import MapGeometry, edges_of
from light_transport.rays.row_numbers import row_numbers
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray, IntArray

NO_GROUP, BY_TEXELS = -1, -2
# More than these, which 16 bits can name, are not told apart; boxes of space then become larger.
_MOST = 30_000


class TriangleGroups(NamedTuple):
    """Sides of triangles that lie in one box of space and face one way (G).

    Attributes:
        front, back: (F,) int16, the group of each side of a triangle, or NO_GROUP. The back of a
            sheet that has texels is BY_TEXELS.
        start: (G + 1,) int64, where each group's sides begin in the next two.
        triangle: (K,) int32.
        area_up_to: (K,) float32, area of the group's sides up to this one, over all of them.
        side: (G,) float32, 1 for fronts and -1 for backs.
        area: (G,) float32, in squares of the scene's radius.
    """

    front: NDArray[np.int16]
    back: NDArray[np.int16]
    start: IntArray
    triangle: NDArray[np.int32]
    area_up_to: Float32Array
    side: Float32Array
    area: Float32Array


def groups_of(geometry: MapGeometry, sheets: BoolArray, edge: float) -> TriangleGroups:
    """Groups in boxes of this edge, in radii.

    `sheets` (F,): triangles whose backs are seen. What has texels in the map has no groups.
    """
    has_texels = np.isfinite(geometry.uv).all(axis=(1, 2)) | geometry.on_ground
    fronts, backs = np.flatnonzero(~has_texels), np.flatnonzero(sheets & ~has_texels)
    triangle = np.concatenate([fronts, backs]).astype(np.int32)
    is_front = np.arange(len(triangle)) < len(fronts)
    corner, b, c = edges_of(geometry, triangle)
    area = 0.5 * np.linalg.norm(np.cross(b, c), axis=1)
    facing = np.where(is_front[:, None], 1.0, -1.0) * geometry.faces[triangle].astype(np.float64)
    group = _numbered(corner + (b + c) / 3.0, facing, is_front, edge)
    order = np.argsort(group, kind="stable")
    group, triangle, area, is_front = group[order], triangle[order], area[order], is_front[order]
    count = int(group[-1]) + 1 if len(group) else 0
    start = np.searchsorted(group, np.arange(count + 1))
    total = np.bincount(group, area, count)
    front = np.full(len(geometry.faces), NO_GROUP, np.int16)
    back = front.copy()
    back[sheets & has_texels] = BY_TEXELS
    front[triangle[is_front]], back[triangle[~is_front]] = group[is_front], group[~is_front]
    running = np.concatenate([[0.0], np.cumsum(area)])
    up_to = running[1:] - running[start[:-1]][group]
    return TriangleGroups(
        front,
        back,
        start.astype(np.int64),
        triangle,
        np.divide(up_to, total[group], out=np.ones_like(up_to), where=total[group] > 0.0).astype(
            np.float32
        ),
        np.where(is_front[start[:-1]], 1.0, -1.0).astype(np.float32),
        total.astype(np.float32),
    )


def _numbered(
    middle: FloatArray, facing: FloatArray, is_front: BoolArray, edge: float
) -> NDArray[np.int64]:
    """The number (K,) of each side's group."""
    if len(middle) == 0:
        return np.empty(0, np.int64)
    axis = np.argmax(np.abs(facing), axis=1)
    positive = np.take_along_axis(facing, axis[:, None], axis=1)[:, 0] > 0.0
    way = 4 * axis + 2 * positive + is_front
    while True:
        cell = np.floor(middle / edge).astype(np.int64)
        number, count = row_numbers(np.column_stack([cell, way]))
        if count <= _MOST:
            return number
        edge *= 2.0

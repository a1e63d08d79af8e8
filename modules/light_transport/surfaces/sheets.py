"""Sheets: surfaces without a body behind them, whose back sides are seen too.

A ray that meets the back of a body began inside that body. Files mark whole scenes as double-sided,
so the mark alone does not tell a leaf from a house: the shape must be open as well.
"""

import numpy as np
from numpy.typing import NDArray

from light_transport.surfaces.surfaces import GROUND, Surfaces
from vrut_lite.geometry.connected import connected_components
from vrut_lite.numeric_types import BoolArray

# The sum of a closed body's area vectors is 0, a box's without a bottom a fifth of its area, that
# of a flat sheet all of it.
_OPEN = 0.5


def sheets_of(surfaces: Surfaces) -> BoolArray:
    """Which triangles (F,) are double-sided and belong to an open shape."""
    asked = np.flatnonzero(surfaces.double_sided & (surfaces.part != GROUND))
    result = np.zeros(len(surfaces.part), bool)
    if len(asked) == 0:
        return result
    corners = surfaces.corners_m[asked]
    body = _bodies(corners)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.bincount(body, np.linalg.norm(cross, axis=1))
    vector = np.stack([np.bincount(body, cross[:, axis]) for axis in range(3)])
    is_open = np.linalg.norm(vector, axis=0) > _OPEN * area
    result[asked] = is_open[body]
    return result


def _bodies(corners: NDArray[np.float64]) -> NDArray[np.int32]:
    """The connected shape (F,) of each triangle (F, 3, 3): corners at one place are one."""
    bits = np.ascontiguousarray(corners.reshape(-1, 3).astype(np.float32) + 0.0).view(np.uint32)
    scatter = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)
    keys = np.bitwise_xor.reduce(bits.astype(np.uint64) * scatter, axis=1)
    _, place = np.unique(keys, return_inverse=True)
    place = place.reshape(-1, 3)
    count = int(place.max()) + 1
    rows, columns = place[:, [0, 1]].ravel(), place[:, [1, 2]].ravel()
    label = connected_components(count, rows, columns)
    return label[place[:, 0]].astype(np.int32)

"""Charts of a mesh: flat pieces of it, no two of whose triangles share a texel."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import kernel
from light_transport.layout.facing_groups import Groups, connected
from light_transport.layout.nearest_place import signed_area
from light_transport.layout.overlaps import layers
from light_transport.layout.projection import MARGIN_PX, projected
from vrut_lite.numeric_types import FloatArray

# A chart that fills less of its rectangle than this is halved, and its halves again, unless the
# rectangle is small: rings and frames would leave most of the map empty.
_HOLLOW, _LARGE_PX2, _HALVINGS = 0.3, 1024.0, 6


class Charts(NamedTuple):
    """A mesh's charts, each in a rectangle of its own.

    `of` (F,) int32: the chart of each triangle; `uv_px` (F, 3, 2): places of corners, from the
    corner of the chart's rectangle; `sizes` (C, 2) int32: the rectangles. A bilinear look-up
    anywhere on a triangle of a chart stays within its rectangle. `texels`: about how many of the
    rectangles' texels look-ups may meet.
    """

    of: NDArray[np.int32]
    uv_px: FloatArray
    sizes: NDArray[np.int32]
    texels: float


def unwrapped(groups: Groups, corners_px: FloatArray, opposite: NDArray[np.int32]) -> Charts:
    """Charts of groups whose triangles face about one direction each.

    Args:
        groups: see `facing_groups`.
        corners_px: (F, 3, 3), in texels.
        opposite: see `welding.opposite_edges`.
    """
    chart, direction = groups.of, groups.direction
    uv_px, heights_px, sizes = projected(chart, direction, corners_px, opposite)
    for _ in range(_HALVINGS):
        half = _halves(chart, uv_px)
        if not np.any(half):
            break
        chart, first = connected(chart, half, opposite)
        direction = groups.direction[groups.of[first]]
    if len(direction) > len(groups.direction):
        uv_px, heights_px, sizes = projected(chart, direction, corners_px, opposite)
    layer = layers(chart, uv_px, heights_px, sizes, opposite)
    if np.any(layer):
        chart = connected(chart, layer, opposite)[0]
    lower, upper, _ = _extents(chart, uv_px)
    # Whole texels are taken off: which middles lie in a triangle does not change.
    corner = np.floor(lower - 0.5 - MARGIN_PX)
    sizes = (np.ceil(upper - 0.5 + MARGIN_PX) - corner + 1.0).astype(np.int32)
    return Charts(chart, uv_px - corner[chart][:, None], sizes, _needed(chart, uv_px, opposite))


@kernel
def _halves(chart, uv):  # type: ignore[no-untyped-def]
    """1 (F,) for triangles in the second half of a hollow chart, else 0."""
    lower, upper, area = _extents(chart, uv)
    half = np.zeros(len(chart), np.int32)
    for f in range(len(chart)):
        c = chart[f]
        wide, high = upper[c, 0] - lower[c, 0], upper[c, 1] - lower[c, 1]
        whole = wide * high
        if whole > _LARGE_PX2 and area[c] < _HOLLOW * whole:
            k = 0 if wide >= high else 1
            middle = (uv[f, 0, k] + uv[f, 1, k] + uv[f, 2, k]) / 3.0
            half[f] = 1 if middle > 0.5 * (lower[c, k] + upper[c, k]) else 0
    return half


@kernel
def _needed(chart, uv, opposite):  # type: ignore[no-untyped-def]
    """About how many texels lie in triangles or beside the charts' borders."""
    lower, upper, area = _extents(chart, uv)
    for f in range(len(chart)):
        for e in range(3):
            if opposite[f, e] < 0 or chart[opposite[f, e] // 3] != chart[f]:
                a, b = uv[f, e], uv[f, (e + 1) % 3]
                area[chart[f]] += np.hypot(b[0] - a[0], b[1] - a[1])
    whole = 0.0
    for c in range(len(area)):
        wide = np.ceil(upper[c, 0] - lower[c, 0]) + 1.0
        high = np.ceil(upper[c, 1] - lower[c, 1]) + 1.0
        whole += min(area[c] + 2.0, wide * high)
    return whole


@kernel
def _extents(chart, uv):  # type: ignore[no-untyped-def]
    """Lower and upper bounds (C, 2) of charts, and the area (C,) of their triangles."""
    charts = 0
    for f in range(len(chart)):
        charts = max(charts, chart[f] + 1)
    lower, upper = np.full((charts, 2), np.inf), np.full((charts, 2), -np.inf)
    area = np.zeros(charts)
    for f in range(len(chart)):
        for c in range(3):
            for k in range(2):
                lower[chart[f], k] = min(lower[chart[f], k], uv[f, c, k])
                upper[chart[f], k] = max(upper[chart[f], k], uv[f, c, k])
        area[chart[f]] += 0.5 * abs(signed_area(uv[f, 0], uv[f, 1], uv[f, 2, 0], uv[f, 2, 1]))
    return lower, upper, area

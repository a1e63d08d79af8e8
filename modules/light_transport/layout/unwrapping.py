"""Charts of a mesh: flat pieces of it, no two of whose triangles share a texel."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import kernel
from light_transport.layout.facing_groups import Groups, connected
from light_transport.layout.nearest_place import signed_area
from light_transport.layout.overlaps import layers
from light_transport.layout.projection import MARGIN_PX, STEPS_PER_PX, projected
from vrut_lite.numeric_types import FloatArray

# A chart that is narrower than this, in texels, is one texel wide, which is looked up in its
# middle: strips need no texels beside them. In its texel a strip ends so far from the border.
_NARROW_PX, _FROM_BORDER_PX = 1.0, 1.0 / 64.0
# A chart that fills less of its rectangle than this is halved, and its halves again, unless the
# rectangle is small: rings and frames would leave most of the map empty.
_HOLLOW, _LARGE_PX2, _HALVINGS = 0.3, 1024.0, 6


class Charts(NamedTuple):
    """A mesh's charts, each in a rectangle of its own.

    `of` (F,) int32: the chart of each triangle; `uv_px` (F, 3, 2): places of corners, from the
    corner of the chart's rectangle; `look_up_px` (F, 3, 2): where corners are looked up, the same
    but in charts of one texel's width, which fill it and are looked up in its middle; `sizes`
    (C, 2) int32: the rectangles. A bilinear look-up anywhere on a triangle of a chart stays within
    its rectangle. `texels`: about how many of the rectangles' texels look-ups may meet.
    """

    of: NDArray[np.int32]
    uv_px: FloatArray
    look_up_px: FloatArray
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
    narrow = upper - lower < _NARROW_PX
    sizes[narrow] = 1
    rectangles = np.where(narrow, 1.0, np.ceil(upper - lower) + 1.0).prod(axis=1)
    needed = np.minimum(_with_borders(chart, uv_px, opposite) + 2.0, rectangles).sum()
    own_px = uv_px - corner[chart][:, None]
    in_narrow = narrow[chart][:, None]
    filled_px = _filled(uv_px, lower[chart][:, None], upper[chart][:, None])
    return Charts(
        chart,
        np.where(in_narrow, filled_px, own_px),
        np.where(in_narrow, 0.5, own_px),
        sizes,
        float(needed),
    )


def _filled(uv_px: FloatArray, lower_px: FloatArray, upper_px: FloatArray) -> FloatArray:
    """Places (F, 3, 2) such that what lies between two bounds (F, 1, 2) fills one texel."""
    extent_px = upper_px - lower_px
    share = np.divide(
        uv_px - lower_px, extent_px, out=np.full_like(uv_px, 0.5), where=extent_px > 0.0
    )
    filled_px = _FROM_BORDER_PX + (1.0 - 2.0 * _FROM_BORDER_PX) * share
    return np.asarray(np.round(filled_px * STEPS_PER_PX) / STEPS_PER_PX)


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
def _with_borders(chart, uv, opposite):  # type: ignore[no-untyped-def]
    """About how many texels (C,) lie in the triangles of charts or beside their borders."""
    area = _extents(chart, uv)[2]
    for f in range(len(chart)):
        for e in range(3):
            if opposite[f, e] < 0 or chart[opposite[f, e] // 3] != chart[f]:
                a, b = uv[f, e], uv[f, (e + 1) % 3]
                area[chart[f]] += np.hypot(b[0] - a[0], b[1] - a[1])
    return area


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

"""Charts of a mesh: flat pieces of it, no two of whose triangles share a texel.

Each group of triangles is projected onto the plane that it faces. Coordinates are whole multiples
of 2^-10 of a texel: exact in float32 in a map of any size that a GPU takes, so that the triangle of
a texel's middle is decided without rounding.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import cross, dot, kernel
from light_transport.layout.facing_groups import FacingGroups, connected
from light_transport.layout.overlaps import layers
from light_transport.layout.texel_owners import signed_area
from vrut_lite.numeric_types import FloatArray

# Width in texels below which a chart is one texel wide and is looked up in its middle, so that
# strips need no texels beside them; distance of a strip from its texel's border.
_NARROW_PX, _FROM_BORDER_PX = 1.0, 1.0 / 64.0
# A chart that fills less of its rectangle than this is halved, and its halves again, unless the
# rectangle is small: rings and frames would leave most of the map empty.
_HOLLOW, _LARGE_PX2, _HALVINGS = 0.3, 1024.0, 6
STEPS_PER_PX = 1024.0
# A look-up this far beside a chart, in texels, still finds the chart's own texels: GPUs round
# coordinates of a look-up to 1/256 of a texel.
MARGIN_PX = 1.0 / 16.0
# Turns that are tried for the smallest rectangle, beside that along the longest border.
_TURNS = 15


class Charts(NamedTuple):
    """A mesh's charts, a rectangle each.

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


def unwrapped(groups: FacingGroups, corners_px: FloatArray, opposite: NDArray[np.int32]) -> Charts:
    """Charts of groups whose triangles face about one direction each.

    Args:
        groups: see `facing_groups`.
        corners_px: (F, 3, 3), in texels.
        opposite: see `seams.opposite_edges`.
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
    """Places (F, 3, 2) scaled so that two bounds (F, 1, 2) are one texel apart."""
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


@kernel
def projected(group, direction, corners, opposite):  # type: ignore[no-untyped-def]
    """Places (F, 3, 2) of corners in their group's plane, and their heights (F, 3) above it.

    Groups are turned to fill a lying rectangle best; its size (G, 2) comes third.

    Args:
        group, direction: see `facing_groups.Groups`.
        corners: (F, 3, 3), in texels.
        opposite: see `seams.opposite_edges`.
    """
    groups = len(direction)
    axes = np.empty((groups, 2, 3))
    for g in range(groups):
        n, u, v = direction[g], axes[g, 0], axes[g, 1]
        seldom = 0
        for k in range(3):
            if abs(n[k]) < abs(n[seldom]):
                seldom = k
        for k in range(3):
            v[k] = 1.0 if k == seldom else 0.0
        cross(v, n, u)
        length = np.sqrt(dot(u, u))
        for k in range(3):
            u[k] /= length
        cross(n, u, v)
    uv, heights = np.empty((len(group), 3, 2)), np.empty((len(group), 3))
    longest = np.zeros(groups)
    # The directions that are tried, the first of them along the longest border.
    turn = np.zeros((groups, 1 + _TURNS, 2))
    for g in range(groups):
        turn[g, 0, 0] = 1.0
        for k in range(1, 1 + _TURNS):
            turn[g, k, 0] = np.cos(0.5 * np.pi * (k - 1) / _TURNS)
            turn[g, k, 1] = np.sin(0.5 * np.pi * (k - 1) / _TURNS)
    for f in range(len(group)):
        g = group[f]
        for k in range(3):
            uv[f, k, 0] = dot(corners[f, k], axes[g, 0])
            uv[f, k, 1] = dot(corners[f, k], axes[g, 1])
            heights[f, k] = dot(corners[f, k], direction[g])
        for e in range(3):
            if opposite[f, e] < 0 or group[opposite[f, e] // 3] != g:
                du = uv[f, (e + 1) % 3, 0] - uv[f, e, 0]
                dv = uv[f, (e + 1) % 3, 1] - uv[f, e, 1]
                length = np.sqrt(du * du + dv * dv)
                # Among equal ones the first, whatever the last digit.
                if length > 1.000001 * longest[g]:
                    longest[g] = length
                    turn[g, 0, 0], turn[g, 0, 1] = du / length, dv / length
    lower = np.full((groups, 1 + _TURNS, 2), np.inf)
    upper = np.full((groups, 1 + _TURNS, 2), -np.inf)
    for f in range(len(group)):
        g = group[f]
        for c in range(3):
            for k in range(1 + _TURNS):
                a, b = turn[g, k, 0], turn[g, k, 1]
                s, t = a * uv[f, c, 0] + b * uv[f, c, 1], a * uv[f, c, 1] - b * uv[f, c, 0]
                lower[g, k, 0], lower[g, k, 1] = min(lower[g, k, 0], s), min(lower[g, k, 1], t)
                upper[g, k, 0], upper[g, k, 1] = max(upper[g, k, 0], s), max(upper[g, k, 1], t)
    best = np.zeros(groups, np.int64)
    sizes = np.empty((groups, 2), np.int64)
    lies = np.empty(groups, np.bool_)
    for g in range(groups):
        least = np.inf
        for k in range(1 + _TURNS):
            wide, high = upper[g, k, 0] - lower[g, k, 0], upper[g, k, 1] - lower[g, k, 1]
            area = (wide + 1.0) * (high + 1.0)
            if area < 0.98 * least:
                best[g], least = k, area
        k = best[g]
        lies[g] = upper[g, k, 0] - lower[g, k, 0] >= upper[g, k, 1] - lower[g, k, 1]
    for f in range(len(group)):
        g = group[f]
        k = best[g]
        a, b = turn[g, k, 0], turn[g, k, 1]
        for c in range(3):
            s = a * uv[f, c, 0] + b * uv[f, c, 1] - lower[g, k, 0]
            t = a * uv[f, c, 1] - b * uv[f, c, 0] - lower[g, k, 1]
            if not lies[g]:
                s, t = upper[g, k, 1] - lower[g, k, 1] - t, s
            uv[f, c, 0], uv[f, c, 1] = s, t
    for g in range(groups):
        k = best[g]
        wide, high = upper[g, k, 0] - lower[g, k, 0], upper[g, k, 1] - lower[g, k, 1]
        if not lies[g]:
            wide, high = high, wide
        sizes[g, 0] = int(np.ceil(wide + 2.0 * MARGIN_PX)) + 1
        sizes[g, 1] = int(np.ceil(high + 2.0 * MARGIN_PX)) + 1
        # Centred in whole texels.
        lower[g, 0, 0] = 0.5 * (sizes[g, 0] - wide)
        lower[g, 0, 1] = 0.5 * (sizes[g, 1] - high)
    for f in range(len(group)):
        for c in range(3):
            for k in range(2):
                at = uv[f, c, k] + lower[group[f], 0, k]
                uv[f, c, k] = np.round(at * STEPS_PER_PX) / STEPS_PER_PX
    return uv, heights, sizes

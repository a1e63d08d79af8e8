"""Charts whose projection would cover a texel twice, taken apart into layers."""

import numpy as np

from light_transport.kernels import inlined, kernel
from light_transport.layout.texel_owners import REACH_PX, nearest, signed_area

# Places beside each other in a chart, whose heights differ by more texels than this and slopes
# explain, are not beside each other on the surface: light of one would reach the other.
_STEP_PX = 4.0
_FEW_TEXELS = 25


@kernel
def layers(chart, uv, heights, sizes, opposite):  # type: ignore[no-untyped-def]
    """The layer (F,) of each triangle; triangles of one layer and chart share no texel.

    A texel's middle lies in one triangle, or on borders; look-ups on a triangle (`REACH_PX`) meet
    none from far above or below it. Triangles of one number need not be connected.

    Triangles are taken in the order of a walk from neighbour to neighbour, each into the layer of
    the one before if its texels are free there, else into the newest or a new one: a turn of a
    winding stair becomes a chart. Claims of a texel are a linked list, one a layer.

    Args:
        chart: (F,).
        uv: (F, 3, 2), in texels from the corner of the chart's rectangle.
        heights: (F, 3), in texels above the chart's plane.
        sizes: (C, 2), of the rectangles.
        opposite: see `seams.opposite_edges`.
    """
    count = len(chart)
    first = np.zeros(len(sizes) + 1, np.int64)
    most = 0
    for c in range(len(sizes)):
        texels_here = np.int64(sizes[c, 0]) * np.int64(sizes[c, 1])
        first[c + 1] = first[c] + texels_here
        most = max(most, texels_here)
    head = np.full(first[-1], -1, np.int32)
    follows, claimed = np.empty(1024, np.int32), np.empty(1024, np.int32)
    # Claims: whether a triangle covers the middle, its lowest and its highest place.
    covered, lowest, highest = np.empty(1024, np.bool_), np.empty(1024), np.empty(1024)
    claims = 0
    # Texels that one triangle meets.
    texels, inside, height = np.empty(most, np.int64), np.empty(most, np.bool_), np.empty(most)
    layer = np.full(count, -1, np.int32)
    newest = np.zeros(len(sizes), np.int32)
    queue = np.empty(count, np.int32)
    for seed in range(count):
        if layer[seed] >= 0:
            continue
        c = chart[seed]
        layer[seed], queue[0], begin, end = newest[c], seed, 0, 1
        while begin < end:
            f = queue[begin]
            begin += 1
            slack = _STEP_PX + 2.0 * REACH_PX * _slope(uv[f], heights[f])
            met = _meet(uv[f], heights[f], sizes[c], texels, inside, height)
            # If not into its own layer, into the newest, where its neighbours may be already.
            for _ in range(2):
                free = True
                for k in range(met):
                    claim = head[first[c] + texels[k]]
                    while claim >= 0 and claimed[claim] != layer[f]:
                        claim = follows[claim]
                    if claim >= 0 and (
                        (inside[k] and covered[claim])
                        or height[k] > lowest[claim] + slack
                        or height[k] < highest[claim] - slack
                    ):
                        free = False
                        break
                if free or layer[f] == newest[c]:
                    break
                layer[f] = newest[c]
            if not free:
                newest[c] += 1
                layer[f] = newest[c]
            for k in range(met):
                at = first[c] + texels[k]
                claim = head[at]
                while claim >= 0 and claimed[claim] != layer[f]:
                    claim = follows[claim]
                if claim < 0:
                    if claims == len(claimed):
                        follows = np.concatenate((follows, follows))
                        claimed = np.concatenate((claimed, claimed))
                        covered = np.concatenate((covered, covered))
                        lowest = np.concatenate((lowest, lowest))
                        highest = np.concatenate((highest, highest))
                    claim = claims
                    claims += 1
                    follows[claim], claimed[claim], head[at] = head[at], layer[f], claim
                    covered[claim], lowest[claim], highest[claim] = False, np.inf, -np.inf
                covered[claim] = covered[claim] or inside[k]
                lowest[claim] = min(lowest[claim], height[k])
                highest[claim] = max(highest[claim], height[k])
            for e in range(3):
                g = opposite[f, e] // 3
                if opposite[f, e] >= 0 and chart[g] == c and layer[g] < 0:
                    layer[g] = layer[f]
                    queue[end] = g
                    end += 1
    return layer


@inlined
def _slope(corners, heights):  # type: ignore[no-untyped-def]
    """Rise over run of a triangle, 0 without area."""
    a, b, c = corners
    area = signed_area(a, b, c[0], c[1])
    p, q = heights[1] - heights[0], heights[2] - heights[0]
    if area == 0.0:
        return 0.0
    across = (p * (c[1] - a[1]) - q * (b[1] - a[1])) / area
    down = (q * (b[0] - a[0]) - p * (c[0] - a[0])) / area
    # The sliver of a slope says little: no chart's triangle is steeper than five.
    return min(np.hypot(across, down), 5.0)


@kernel
def _meet(corners, heights, size, texels, inside, height):  # type: ignore[no-untyped-def]
    """How many texels of a rectangle look-ups on a triangle meet.

    They are put into `texels`, as row times width and column, beside whether their middles lie
    inside it, not on its border, and the height of a place near by.
    """
    a, b, c = corners
    low_x, high_x = min(a[0], b[0], c[0]), max(a[0], b[0], c[0])
    low_y, high_y = min(a[1], b[1], c[1]), max(a[1], b[1], c[1])
    left, right = max(int(np.floor(low_x - 1.0)), 0), min(int(np.ceil(high_x + 1.0)), size[0])
    top, bottom = max(int(np.floor(low_y - 1.0)), 0), min(int(np.ceil(high_y + 1.0)), size[1])
    area = signed_area(a, b, c[0], c[1])
    # Small triangles take all texels of their bounds, at their mean height, which is fast.
    is_small = (right - left) * (bottom - top) <= _FEW_TEXELS
    mean = (heights[0] + heights[1] + heights[2]) / 3.0
    count = 0
    for row in range(top, bottom):
        for column in range(left, right):
            x, y = column + 0.5, row + 0.5
            above = mean
            if not is_small:
                distance2, above = nearest(corners, heights, x, y)
                if distance2 > REACH_PX * REACH_PX:
                    continue
            covers = (
                low_x < x < high_x
                and low_y < y < high_y
                and signed_area(a, b, x, y) * area > 0.0
                and signed_area(b, c, x, y) * area > 0.0
                and signed_area(c, a, x, y) * area > 0.0
            )
            texels[count], inside[count], height[count] = row * size[0] + column, covers, above
            count += 1
    return count

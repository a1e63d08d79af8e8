"""Texels of two charts that meet at a smooth edge.

A chart ends where its neighbour begins, also where the surface goes on smoothly. Smoothing
exchanges light between these pairs as between neighbouring texels, so that no seam is visible.

Corners at one place, and the triangles on both sides of an edge, are found by hash tables with open
addressing, in a time linear in the number of triangles.
"""

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import agree, inlined, kernel
from light_transport.layout.texel_owners import UNUSED
from vrut_lite.numeric_types import Float32Array, FloatArray

NO_EDGE = -1
_CROWDED = -2
# Odd constants whose products scatter keys over a table (Knuth's multiplicative hashing).
_SCATTER = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)


def seam_texels(
    corners_m: FloatArray,
    normals: Float32Array,
    uv_px: Float32Array,
    chart: NDArray[np.int32],
    owner: NDArray[np.int32],
) -> NDArray[np.int32]:
    """Pairs of texels that lie at the same smooth edge, in two charts.

    Beside each place of the edge, half a texel apart, both charts have a texel within the border
    and one beyond it. The texels within are a pair, and so is each texel beyond with the other
    chart's within, which lies at about the same place: a texel that no triangle covers may take
    that one's light.

    Args:
        corners_m, normals: (F, 3, 3), of triangles in one frame.
        uv_px: (F, 3, 2), NaN where a triangle has no texels.
        chart: (F,), numbers of charts, negative without texels.
        owner: (height, width), see `texel_owners`.

    Returns:
        (S, 2) int32, texels as row * width + column, the smaller first, sorted, each pair once.
    """
    mapped = np.flatnonzero(chart >= 0)
    if not len(mapped):
        return np.empty((0, 2), np.int32)
    places = welded(corners_m[mapped].reshape(-1, 3)).reshape(-1, 3)
    pairs = _pairs(
        opposite_edges(places),
        normals[mapped],
        uv_px[mapped].astype(np.float64),
        chart[mapped],
        np.append(chart, UNUSED)[owner],
    )
    pairs.sort(axis=1)
    key = np.unique(pairs[:, 0] * owner.size + pairs[:, 1])
    return np.stack([key // owner.size, key % owner.size], axis=1).astype(np.int32)


@kernel
def _pairs(opposite, normals, uv, chart, texel_chart):  # type: ignore[no-untyped-def]
    """Pairs (n, 2) of texels at smooth edges, each as often as it is met."""
    found = np.empty((1024, 2), np.int64)
    count = 0
    own, across = np.empty((2, 2)), np.empty((2, 2))
    for f in range(len(chart)):
        for e in range(3):
            g, d = divmod(opposite[f, e], 3)
            # Each edge once, from the triangle that comes first.
            if opposite[f, e] == NO_EDGE or g < f or chart[f] == chart[g]:
                continue
            after, beyond = (e + 1) % 3, (d + 1) % 3
            if not agree(normals, f, e, g, d):
                continue
            long = max(_length(uv[f, e], uv[f, after]), _length(uv[g, d], uv[g, beyond]))
            steps = int(np.ceil(2.0 * long)) + 1
            for step in range(steps):
                share = (step + 0.5) / steps
                _beside(uv[f, e], uv[f, after], uv[f, (e + 2) % 3], share, own)
                _beside(uv[g, beyond], uv[g, d], uv[g, (d + 2) % 3], share, across)
                for k in range(3):
                    one = _texel(own[1 if k == 1 else 0], chart[f], texel_chart)
                    two = _texel(across[1 if k == 2 else 0], chart[g], texel_chart)
                    if one < 0 or two < 0:
                        continue
                    if count == len(found):
                        found = np.concatenate((found, found))
                    found[count, 0], found[count, 1] = one, two
                    count += 1
    return found[:count].copy()


@inlined
def _length(a, b):  # type: ignore[no-untyped-def]
    return np.hypot(b[0] - a[0], b[1] - a[1])


@inlined
def _beside(a, b, inner, share, places):  # type: ignore[no-untyped-def]
    """Places (2, 2) half a texel within an edge and beyond it, at a share of its length."""
    du, dv = b[0] - a[0], b[1] - a[1]
    length = max(np.hypot(du, dv), 1e-9)
    side = 0.5 if du * (inner[1] - a[1]) - dv * (inner[0] - a[0]) >= 0.0 else -0.5
    across, down = -side * dv / length, side * du / length
    places[0, 0] = a[0] + share * du + across
    places[0, 1] = a[1] + share * dv + down
    places[1, 0] = a[0] + share * du - across
    places[1, 1] = a[1] + share * dv - down


@inlined
def _texel(place, chart, texel_chart):  # type: ignore[no-untyped-def]
    """The texel of a chart at a place, as row * width + column; -1 if it is another's."""
    x, y = int(np.floor(place[0])), int(np.floor(place[1]))
    height, width = texel_chart.shape
    if x < 0 or y < 0 or x >= width or y >= height or texel_chart[y, x] != chart:
        return -1
    return y * width + x


def welded(points_m: FloatArray) -> NDArray[np.int32]:
    """For each point (N, 3) the number of the first point at the same place."""
    # A sum with zero makes -0 and 0 one.
    bits = np.ascontiguousarray(points_m + 0.0).view(np.uint64)
    return np.asarray(_firsts_of_rows(bits, _SCATTER))


def opposite_edges(*corners: NDArray[np.int32]) -> NDArray[np.int32]:
    """For each edge (F, 3) of triangles the edge 3 f + e of the triangle across it.

    Edge e runs from corner e to the next one. Each of `corners` (F, 3) numbers the same corners;
    edges that find no partner by the first find one by the next. Thus sheets back to back, which
    have separate vertices at the same places, stay apart.

    Returns:
        (F, 3) int32, `NO_EDGE` where no triangle, or more than one, lies across.
    """
    opposite = np.full(corners[0].shape, NO_EDGE, np.int32)
    for numbers in corners:
        _match_edges(np.ascontiguousarray(numbers, np.int64), opposite)
    return opposite


@kernel
def _firsts_of_rows(rows, scatter):  # type: ignore[no-untyped-def]
    count = len(rows)
    size = 16
    while size < 2 * count:
        size *= 2
    mask = np.uint64(size - 1)
    table = np.full(size, -1, np.int32)
    first = np.empty(count, np.int32)
    for i in range(count):
        key = np.uint64(0)
        # Round numbers have bits at one end alone, which two rounds more spread over all.
        for k in range(5):
            key = (key ^ rows[i, k % 3]) * scatter[k % 3]
            key ^= key >> np.uint64(32)
        slot = key & mask
        while True:
            other = table[slot]
            if other < 0:
                table[slot] = i
                first[i] = i
                break
            if (
                rows[other, 0] == rows[i, 0]
                and rows[other, 1] == rows[i, 1]
                and rows[other, 2] == rows[i, 2]
            ):
                first[i] = other
                break
            slot = (slot + np.uint64(1)) & mask
    return first


@kernel
def _match_edges(corners, opposite):  # type: ignore[no-untyped-def]
    """Pair the edges that have no partner yet and two of whose triangles share both ends."""
    size = 16
    while size < 4 * len(corners):
        size *= 2
    mask = size - 1
    # The one or two edges between a pair of places; `_CROWDED` in place of the second.
    edges = np.full((size, 2), NO_EDGE, np.int32)
    for f in range(len(corners)):
        for e in range(3):
            a, b = corners[f, e], corners[f, (e + 1) % 3]
            if opposite[f, e] >= 0 or a == b:
                continue
            slot = (min(a, b) * 0x9E3779B1 + max(a, b) * 0x85EBCA77) & mask
            slot = (slot ^ (slot >> 7)) & mask
            while edges[slot, 0] >= 0:
                one, k = divmod(edges[slot, 0], 3)
                c, d = corners[one, k], corners[one, (k + 1) % 3]
                if (a == c and b == d) or (a == d and b == c):
                    break
                slot = (slot + 1) & mask
            if edges[slot, 0] < 0:
                edges[slot, 0] = 3 * f + e
            elif edges[slot, 1] == NO_EDGE:
                edges[slot, 1] = 3 * f + e
            else:
                edges[slot, 1] = _CROWDED
    for slot in range(size):
        one, two = edges[slot]
        if two < 0 or one // 3 == two // 3:
            continue
        # Triangles of one winding run along their common edge in opposite directions.
        if corners[one // 3, one % 3] != corners[two // 3, two % 3]:
            opposite[one // 3, one % 3] = two
            opposite[two // 3, two % 3] = one

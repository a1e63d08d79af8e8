"""Finds corners at the same place, and the triangles on both sides of each edge.

Hash tables with open addressing keep both linear in the number of triangles.
"""

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import kernel
from vrut_lite.numeric_types import FloatArray

NO_EDGE = -1
_CROWDED = -2
# Odd constants whose products scatter keys over a table (Knuth's multiplicative hashing).
_SCATTER = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)


def welded(points_m: FloatArray) -> NDArray[np.int32]:
    """For each point (N, 3) the number of the first point at the same place."""
    # A sum with zero makes -0 and 0 one.
    bits = np.ascontiguousarray(points_m + 0.0).view(np.uint64)
    return np.asarray(_firsts_of_rows(bits, _SCATTER))


def opposite_edges(*corners: NDArray[np.int32]) -> NDArray[np.int32]:
    """For each edge (F, 3) of triangles the edge 3 f + e of the triangle across it.

    Edge e runs from corner e to the next one. Each of `corners` (F, 3) numbers the same corners;
    edges that find no partner by the first find one by the next. Thus sheets back to back, which
    have vertices of their own at the same places, stay apart.

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

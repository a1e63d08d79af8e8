"""Groups of triangles that are small for the texels become part of a neighbour."""

import math

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import dot, kernel
from light_transport.layout.facing_groups import Groups, mean_directions
from vrut_lite.numeric_types import FloatArray

# In texels: a chart of this area has as many texels beside its border as within.
_SMALL_PX2 = 16.0
# Least cosine between a triangle's normal and what its chart faces after a merger: stretched twice;
# and that for what is hardly larger than a texel, where it is stretched five times.
_LEAST, _LEAST_OF_TINY, _TINY_PX2 = 0.5, 0.2, 2.0
_ROUNDS = 8


def merged(
    groups: Groups,
    corners_px: FloatArray,
    normals: FloatArray,
    areas_px2: FloatArray,
    opposite: NDArray[np.int32],
) -> Groups:
    """The groups, of which small ones have joined those with which they share most of their border.

    Args:
        groups: connected ones.
        corners_px: (F, 3, 3), in texels.
        normals: (F, 3), unit; zero where a triangle has no area.
        areas_px2: (F,), in texels.
        opposite: see `welding.opposite_edges`.
    """
    group, direction = groups.of.copy(), groups.direction
    for _ in range(_ROUNDS):
        into = _best_neighbours(group, direction, corners_px, normals, areas_px2, opposite)
        if not np.any(into != np.arange(len(into))):
            break
        group = into[group]
        direction = mean_directions(normals, areas_px2, group, direction)
    used, inverse = np.unique(group, return_inverse=True)
    return Groups(np.asarray(inverse.reshape(-1), np.int32), direction[used])


@kernel
def _best_neighbours(  # type: ignore[no-untyped-def]
    group, direction, corners, normals, areas, opposite
):
    """For each group the one that it joins, itself if none.

    A group that others join does not move in the same round: `into` needs no second look-up.
    """
    groups = len(direction)
    first = np.zeros(groups + 1, np.int64)
    area = np.zeros(groups)
    for f in range(len(group)):
        first[group[f] + 1] += 1
        area[group[f]] += areas[f]
    for g in range(groups):
        first[g + 1] += first[g]
    members = np.empty(len(group), np.int32)
    filled = first.copy()
    for f in range(len(group)):
        members[filled[group[f]]] = f
        filled[group[f]] += 1
    into = np.arange(groups).astype(np.int32)
    joined = np.zeros(groups, np.bool_)
    border = np.zeros(groups)
    for g in range(groups):
        if area[g] > _SMALL_PX2 or joined[g]:
            continue
        best, longest = g, 0.0
        for k in range(first[g], first[g + 1]):
            f = members[k]
            for e in range(3):
                other = group[opposite[f, e] // 3] if opposite[f, e] >= 0 else np.int32(g)
                if other == g:
                    continue
                length2 = 0.0
                for axis in range(3):
                    length2 += (corners[f, (e + 1) % 3, axis] - corners[f, e, axis]) ** 2
                border[other] += math.sqrt(length2)
                # Beside an equal border the larger group wins.
                if border[other] > longest or best == g:
                    best, longest = other, border[other]
        for k in range(first[g], first[g + 1]):
            for e in range(3):
                if opposite[members[k], e] >= 0:
                    border[group[opposite[members[k], e] // 3]] = 0.0
        if best == g or into[best] != best:
            continue
        fits, least = True, _LEAST_OF_TINY if area[g] <= _TINY_PX2 else _LEAST
        for k in range(first[g], first[g + 1]):
            f = members[k]
            if dot(normals[f], direction[best]) < least and areas[f] > 0.0:
                fits = False
                break
        if fits:
            into[g] = best
            joined[best] = True
    return into

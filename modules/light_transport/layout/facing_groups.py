"""Smooth surfaces, cut into groups of triangles that face one direction.

A surface whose normals stay within a cone is one group and faces its mean normal: a wall, a slope,
a landscape. A rounder one is cut along the six directions of a frame that its most frequent
normals make, so that a turned box with rounded edges is cut like an upright one. Groups
that are small for the texels then become part of a neighbour.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import agree, cross, dot, inlined, kernel
from vrut_lite.numeric_types import FloatArray

# Least cosine between two triangles' normals in a smooth surface; a crease (40 degrees) ends it,
# unless the shading normals of both agree.
_CREASE = 0.766
# A triangle is stretched by the reciprocal of the cosine between its normal and its chart's: most
# of a single group stays below 1.7, and all of it below 5.
_COMMON, _LEAST, _STEEP_SHARE = 0.6, 0.2, 0.03
# A triangle whose two best directions are this close in cosine follows its neighbours, unless that
# costs more than `_YIELD` of cosine: near 45 degrees noise does not shatter a surface.
_UNDECIDED, _YIELD = 0.12, 0.1
# Cells of the square that normals are counted in, and of the quarter turn about the first.
_CELLS, _TURNS = 16, 36
# Area in texels below which a chart has more texels beside its border than within.
_SMALL_PX2 = 16.0
# Least cosine between a triangle's normal and its chart's after a merger, which stretches it twice;
# and that for a group hardly larger than a texel, which it stretches five times.
_LEAST_MERGED, _LEAST_OF_TINY, _TINY_PX2 = 0.5, 0.2, 2.0
_ROUNDS = 8


class FacingGroups(NamedTuple):
    """Connected groups of triangles.

    `of` (F,) int32: the group of each triangle; `direction` (G, 3): their facing.
    """

    of: NDArray[np.int32]
    direction: FloatArray


def facing_groups(
    normals: FloatArray, areas: FloatArray, opposite: NDArray[np.int32], shading: FloatArray
) -> FacingGroups:
    """Groups of triangles that face their group's direction within about 70 degrees.

    Args:
        normals: (F, 3), unit, of the triangles' planes; zero where one has no area.
        areas: (F,), in any unit.
        opposite: see `seams.opposite_edges`.
        shading: (F, 3, 3), unit normals of the corners.
    """
    # Triangles without an area take a neighbour's normal.
    normals = normals.copy()
    surface, surfaces = _smooth_surfaces(normals, areas, opposite, shading)
    label, directions = _labels(normals, areas, surface, surfaces, opposite)
    group, first = connected(surface, label, opposite)
    return FacingGroups(group, mean_directions(normals, areas, group, directions[label[first]]))


@kernel
def _smooth_surfaces(normals, areas, opposite, shading):  # type: ignore[no-untyped-def]
    """Numbers (F,) of surfaces that creases and open edges end, and how many there are."""
    count = len(areas)
    surface = np.full(count, -1, np.int32)
    queue = np.empty(count, np.int32)
    surfaces = 0
    # In the second round those without an area that touch no other.
    for allowed in range(2):
        for seed in range(count):
            if surface[seed] >= 0 or (allowed == 0 and areas[seed] == 0.0):
                continue
            surface[seed], queue[0], head, tail = surfaces, seed, 0, 1
            while head < tail:
                f = queue[head]
                head += 1
                for e in range(3):
                    if opposite[f, e] < 0:
                        continue
                    g = opposite[f, e] // 3
                    if surface[g] >= 0:
                        continue
                    if areas[g] == 0.0:
                        for k in range(3):
                            normals[g, k] = normals[f, k]
                    elif dot(normals[f], normals[g]) < _CREASE and not agree(
                        shading, f, e, g, opposite[f, e] % 3
                    ):
                        continue
                    surface[g] = surfaces
                    queue[tail] = g
                    tail += 1
            surfaces += 1
    return surface, surfaces


@kernel
def _labels(normals, areas, surface, surfaces, opposite):  # type: ignore[no-untyped-def]
    """The direction of each triangle, as a row of the returned directions."""
    count = len(areas)
    first = np.zeros(surfaces + 1, np.int64)
    for f in range(count):
        first[surface[f] + 1] += 1
    for s in range(surfaces):
        first[s + 1] += first[s]
    members = np.empty(count, np.int32)
    filled = first.copy()
    for f in range(count):
        members[filled[surface[f]]] = f
        filled[surface[f]] += 1
    directions = np.zeros((6 * surfaces, 3))
    label = np.empty(count, np.int32)
    for s in range(surfaces):
        own = members[first[s] : first[s + 1]]
        if _faces_one(normals, areas, own, directions[6 * s]):
            for f in own:
                label[f] = 6 * s
        else:
            _frame(normals, areas, own, directions[6 * s : 6 * s + 6])
            _decide(normals, surface, own, opposite, directions, label)
    return label, directions


@kernel
def _faces_one(normals, areas, own, direction):  # type: ignore[no-untyped-def]
    """Whether triangles face their mean normal; `direction`, 0 before, becomes it."""
    whole = 0.0
    for f in own:
        whole += areas[f]
        for k in range(3):
            direction[k] += areas[f] * normals[f, k]
    if np.sqrt(dot(direction, direction)) <= 1e-9 * whole:
        return whole == 0.0
    _make_unit(direction)
    steep = 0.0
    for f in own:
        cosine = dot(normals[f], direction)
        if cosine < _LEAST:
            return False
        if cosine < _COMMON:
            steep += areas[f]
    return steep <= _STEEP_SHARE * whole


@inlined
def _make_unit(vector):  # type: ignore[no-untyped-def]
    length = max(np.sqrt(dot(vector, vector)), 1e-300)
    for k in range(3):
        vector[k] /= length


@kernel
def _frame(normals, areas, own, directions):  # type: ignore[no-untyped-def]
    """Six directions: the most frequent normal, the most frequent one across it, and so on."""
    counts = np.zeros((_CELLS * _CELLS, 4))
    for f in own:
        n = normals[f]
        size = max(abs(n[0]) + abs(n[1]) + abs(n[2]), 1e-300)
        # A normal and its reverse count together, in an octahedron's half unfolded on a square.
        side = 1.0 if n[1] >= 0.0 else -1.0
        i = int(min(max((0.5 + 0.5 * side * n[0] / size) * _CELLS, 0.0), _CELLS - 1.0))
        j = int(min(max((0.5 + 0.5 * side * n[2] / size) * _CELLS, 0.0), _CELLS - 1.0))
        cell = i * _CELLS + j
        counts[cell, 0] += areas[f]
        for k in range(3):
            counts[cell, 1 + k] += side * areas[f] * n[k]
    best = 0
    for cell in range(len(counts)):
        if counts[cell, 0] > counts[best, 0]:
            best = cell
    x, y, z = counts[best, 1:], np.zeros(3), np.empty(3)
    _make_unit(x)
    seldom = 0
    for k in range(3):
        if abs(x[k]) < abs(x[seldom]):
            seldom = k
    along = x[seldom]
    for k in range(3):
        y[k] = (1.0 if k == seldom else 0.0) - along * x[k]
    _make_unit(y)
    cross(x, y, z)
    turns = np.zeros((_TURNS, 3))
    for f in own:
        p, q = dot(normals[f], y), dot(normals[f], z)
        if p * p + q * q < 0.5:
            continue
        # Four times the angle: quarter turns count together.
        angle = 4.0 * np.arctan2(q, p)
        turn = int(angle / (2.0 * np.pi) % 1.0 * _TURNS) % _TURNS
        turns[turn, 0] += areas[f]
        turns[turn, 1] += areas[f] * np.cos(angle)
        turns[turn, 2] += areas[f] * np.sin(angle)
    best = 0
    for turn in range(_TURNS):
        if turns[turn, 0] > turns[best, 0]:
            best = turn
    angle = 0.25 * np.arctan2(turns[best, 2], turns[best, 1])
    for k in range(3):
        directions[0, k] = x[k]
        directions[2, k] = np.cos(angle) * y[k] + np.sin(angle) * z[k]
    cross(directions[0], directions[2], directions[4])
    for axis in range(0, 6, 2):
        for k in range(3):
            directions[axis + 1, k] = -directions[axis, k]


@kernel
def _decide(normals, surface, own, opposite, directions, label):  # type: ignore[no-untyped-def]
    """Label triangles by their direction, undecided ones as their neighbours."""
    base = 6 * surface[own[0]]
    queue = np.empty(len(own), np.int32)
    head, tail = 0, 0
    for f in own:
        best, lead = _best(normals[f], directions[base : base + 6])
        label[f] = -1
        if lead >= _UNDECIDED:
            label[f] = base + best
            queue[tail] = f
            tail += 1
    while head < tail:
        f = queue[head]
        head += 1
        for e in range(3):
            g = opposite[f, e] // 3
            if opposite[f, e] < 0 or surface[g] != surface[f] or label[g] >= 0:
                continue
            best, _ = _best(normals[g], directions[base : base + 6])
            most = dot(normals[g], directions[base + best])
            if dot(normals[g], directions[label[f]]) >= most - _YIELD:
                label[g] = label[f]
                queue[tail] = g
                tail += 1
    for f in own:
        if label[f] < 0:
            label[f] = base + _best(normals[f], directions[base : base + 6])[0]


@kernel
def _best(normal, directions):  # type: ignore[no-untyped-def]
    """The direction that a normal is nearest to, and its lead in cosine over the next."""
    best, most, second = 0, -2.0, -2.0
    for k in range(len(directions)):
        cosine = dot(normal, directions[k])
        if cosine > most:
            best, most, second = k, cosine, most
        elif cosine > second:
            second = cosine
    return best, most - second


@kernel
def connected(surface, label, opposite):  # type: ignore[no-untyped-def]
    """Numbers (F,) of connected groups of one label in one surface, and the first triangle of each.

    Connected by `opposite` (see `seams.opposite_edges`); `surface` and `label` are (F,) int32.
    """
    count = len(label)
    group = np.full(count, -1, np.int32)
    first = np.empty(count, np.int32)
    queue = np.empty(count, np.int32)
    groups = 0
    for seed in range(count):
        if group[seed] >= 0:
            continue
        group[seed], first[groups], queue[0], head, tail = groups, seed, seed, 0, 1
        while head < tail:
            f = queue[head]
            head += 1
            for e in range(3):
                g = opposite[f, e] // 3
                if (
                    opposite[f, e] >= 0
                    and group[g] < 0
                    and surface[g] == surface[f]
                    and label[g] == label[f]
                ):
                    group[g] = groups
                    queue[tail] = g
                    tail += 1
        groups += 1
    return group, first[:groups].copy()


@kernel
def mean_directions(normals, areas, group, fallback):  # type: ignore[no-untyped-def]
    """Mean normals (G, 3) of groups, or `fallback` where that is nearer to all their triangles.

    Nearer by the worst of them; those without an area do not count.
    """
    groups = len(fallback)
    mean = np.zeros((groups, 3))
    for f in range(len(areas)):
        for k in range(3):
            mean[group[f], k] += areas[f] * normals[f, k]
    least = np.full((groups, 2), 2.0)
    for g in range(groups):
        _make_unit(mean[g])
    for f in range(len(areas)):
        g = group[f]
        if areas[f] == 0.0:
            continue
        least[g, 0] = min(least[g, 0], dot(normals[f], mean[g]))
        least[g, 1] = min(least[g, 1], dot(normals[f], fallback[g]))
    for g in range(groups):
        if least[g, 0] < least[g, 1]:
            for k in range(3):
                mean[g, k] = fallback[g, k]
        if dot(mean[g], mean[g]) < 0.5:
            mean[g, 1] = 1.0
    return mean


def merged(
    groups: FacingGroups,
    corners_px: FloatArray,
    normals: FloatArray,
    areas_px2: FloatArray,
    opposite: NDArray[np.int32],
) -> FacingGroups:
    """The groups, of which small ones have joined those with which they share most of their border.

    Args:
        groups: connected ones.
        corners_px: (F, 3, 3), in texels.
        normals: (F, 3), unit; zero where a triangle has no area.
        areas_px2: (F,), in texels.
        opposite: see `seams.opposite_edges`.
    """
    group, direction = groups.of.copy(), groups.direction
    for _ in range(_ROUNDS):
        into = _best_neighbours(group, direction, corners_px, normals, areas_px2, opposite)
        if not np.any(into != np.arange(len(into))):
            break
        group = into[group]
        direction = mean_directions(normals, areas_px2, group, direction)
    used, inverse = np.unique(group, return_inverse=True)
    return FacingGroups(np.asarray(inverse.reshape(-1), np.int32), direction[used])


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
        fits, least = True, _LEAST_OF_TINY if area[g] <= _TINY_PX2 else _LEAST_MERGED
        for k in range(first[g], first[g + 1]):
            f = members[k]
            if dot(normals[f], direction[best]) < least and areas[f] > 0.0:
                fits = False
                break
        if fits:
            into[g] = best
            joined[best] = True
    return into

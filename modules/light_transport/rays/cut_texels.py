"""Texels that something stands across: walls go on beyond ceilings, sheets end on floors.

Light of one side must not get to the other. A texel that is cut belongs to the side of its `place`:
rays begin there alone, and rays that meet it beyond take a neighbour's light. Texels with something
between them are no neighbours, so that neither patches nor smoothing go through walls, however thin
these are.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import dot, hot, inlined
from light_transport.rays.trace import FAR, MISS, nearest_within
from light_transport.rays.tree import STACK, Tree
from light_transport.surfaces.map_texels import (
    CELLS,
    NOBODY,
    MapGeometry,
    Texels,
    ground_place,
    surface_place,
    triangle_at,
)
from vrut_lite.numeric_types import Float32Array

# What is between two places is looked for so high above the surface, of a texel's width.
_ABOVE = np.float32(0.05)
# The most that what stands across may face as the surface does (cosine): bumps do not count.
_ACROSS = np.float32(0.9)
# Corners of cells lie so far inside their texel, in texels.
_INSIDE = 1e-3
# The square of the farthest that a cell looks for a neighbour, in texels.
_NEAR2 = 4.0
# Where a point lies: in a body, on the side of its texel's `place`, or beyond what cuts the texel.
_BURIED, _OWN, _BEYOND = 0, 1, 2
OverRows = Callable[[int, Callable[[int, int], None]], None]


def cut_texels(
    tree: Tree,
    geometry: MapGeometry,
    texels: Texels,
    links: NDArray[np.int32],
    sheets: NDArray[np.bool_],
    over_rows: OverRows,
) -> tuple[Texels, NDArray[np.int32]]:
    """The texels with what cuts them, and their links (N, 4) without those through walls.

    `sheets` (F,): triangles with two sides; `over_rows` does work on ranges of so many rows.
    """
    count = len(texels.pixel)
    solid = (tree.opacity >= 1.0)[geometry.leaf]
    solid &= np.isfinite(geometry.uv).all(axis=(1, 2)) | geometry.on_ground
    parted = np.zeros((count, 3), bool)
    over_rows(
        count,
        lambda a, b: _part(
            tree, geometry, texels, links, solid, *_stacks(), _places(), a, b, parted
        ),
    )
    links = links.copy()
    for k, back, column in ((1, 0, 0), (3, 2, 1)):
        apart = np.flatnonzero(parted[:, column])
        links[links[apart, k], back] = NOBODY
        links[apart, k] = NOBODY
    cut = np.full(count, NOBODY, np.int32)
    rows = np.flatnonzero(parted[:, 2])
    cut[rows] = np.arange(len(rows), dtype=np.int32)
    cell_row = np.full((len(rows), CELLS * CELLS), NOBODY, np.int32)
    begins = np.zeros(cell_row.shape, bool)
    surfaces = solid & ~sheets, solid
    over_rows(
        len(rows),
        lambda a, b: _sides(
            tree, geometry, texels, surfaces, rows, _stacks(), _places(), a, b, cell_row, begins
        ),
    )
    return texels._replace(cut=cut, cell_row=cell_row, begins=begins), links


def _stacks() -> tuple[NDArray[np.int32], Float32Array]:
    return np.empty(STACK, np.int32), np.empty(STACK, np.float32)


def _places() -> tuple[NDArray[np.float64], ...]:
    return tuple(np.empty(3) for _ in range(6))


@inlined
def _lifted(geometry, texels, row, x, y, weights, place, normal):  # type: ignore[no-untyped-def]
    """Fill in the point above a place in a texel; returns the triangle there."""
    column, line = texels.pixel[row, 0], texels.pixel[row, 1]
    t = texels.triangle[row]
    if geometry.on_ground[t]:
        ground_place(geometry.ground, x, y, place)
    else:
        t = triangle_at(geometry, column, line, x, y, weights)
        surface_place(geometry, t, weights, place, normal)
    for k in range(3):
        place[k] += _ABOVE * texels.width[row] * texels.side[row] * geometry.faces[t, k]
    return t


@inlined
def _apart(tree, geometry, solid, a, b, t, stack, far_stack):  # type: ignore[no-untyped-def]
    """Whether something stands across between two points (3,) above triangle t."""
    _, hit, _, _ = nearest_within(
        tree,
        np.float32(a[0]),
        np.float32(a[1]),
        np.float32(a[2]),
        np.float32(b[0] - a[0]),
        np.float32(b[1] - a[1]),
        np.float32(b[2] - a[2]),
        np.float32(1.0),
        0,
        stack,
        far_stack,
    )
    if hit == MISS:
        return False
    met = tree.order[hit]
    return solid[met] and abs(dot(geometry.faces[met], geometry.faces[t])) < _ACROSS


@hot
def _part(tree, geometry, texels, links, solid, stack, far_stack, places, first, last, parted):  # type: ignore[no-untyped-def]
    """Which texels have something before the one below (N, 3), the one to the right, and in them.

    In a texel both of its diagonals are looked along.
    """
    weights, a, b, normal, _, _ = places
    for i in range(first, last):
        column, line = texels.pixel[i, 0], texels.pixel[i, 1]
        low, high = _INSIDE, 1.0 - _INSIDE
        for k in range(2):
            t = _lifted(
                geometry, texels, i, column + (low if k == 0 else high), line + low, weights, a,
                normal,
            )  # fmt: skip
            _lifted(
                geometry, texels, i, column + (high if k == 0 else low), line + high, weights, b,
                normal,
            )  # fmt: skip
            if _apart(tree, geometry, solid, a, b, t, stack, far_stack):
                parted[i, 2] = True
        t = _lifted(geometry, texels, i, column + 0.5, line + 0.5, weights, a, normal)
        for k in range(2):
            j = links[i, 1 + 2 * k]
            if j != NOBODY:
                x, y = texels.pixel[j, 0] + 0.5, texels.pixel[j, 1] + 0.5
                _lifted(geometry, texels, j, x, y, weights, b, normal)
                parted[i, k] = _apart(tree, geometry, solid, a, b, t, stack, far_stack)


@inlined
def _state(tree, geometry, of_bodies, solid, place, middle, own, t, side, stacks):  # type: ignore[no-untyped-def]
    """Whether a point (3,) above triangle t lies in a body, on the side of a texel's `middle`, or
    beyond what cuts it; `own`: whether that middle is in no body."""
    stack, far_stack = stacks
    if own and not _apart(tree, geometry, solid, middle, place, t, stack, far_stack):
        return _OWN
    _, hit, _, _ = nearest_within(
        tree,
        np.float32(place[0]),
        np.float32(place[1]),
        np.float32(place[2]),
        np.float32(side * geometry.faces[t, 0]),
        np.float32(side * geometry.faces[t, 1]),
        np.float32(side * geometry.faces[t, 2]),
        FAR,
        0,
        stack,
        far_stack,
    )
    if hit != MISS:
        met = tree.order[hit]
        if of_bodies[met] and side * dot(geometry.faces[met], geometry.faces[t]) > 0.0:
            return _BURIED
    return _BEYOND


@hot
def _sides(tree, geometry, texels, surfaces, rows, stacks, places, first, last, cell_row, begins):  # type: ignore[no-untyped-def]
    """Fill in the cells of cut texels by the states of their middles and corners."""
    weights, middle, point, normal, there, beyond = places
    of_bodies, solid = surfaces
    height, width = texels.row_of.shape
    for c in range(first, last):
        i = rows[c]
        column, line, side = texels.pixel[i, 0], texels.pixel[i, 1], texels.side[i]
        t = _lifted(geometry, texels, i, column + 0.5, line + 0.5, weights, middle, normal)
        own = (
            _state(tree, geometry, of_bodies, solid, middle, middle, False, t, side, stacks)
            != _BURIED
        )
        for cell in range(CELLS * CELLS):
            owns, others = 0, 0
            for k in range(5):
                # Its middle, then its corners.
                x = 0.5 if k == 0 else (k - 1) % 2
                y = 0.5 if k == 0 else (k - 1) // 2
                x = column + min(max((cell % CELLS + x) / CELLS, _INSIDE), 1.0 - _INSIDE)
                y = line + min(max((cell // CELLS + y) / CELLS, _INSIDE), 1.0 - _INSIDE)
                _lifted(geometry, texels, i, x, y, weights, point, normal)
                state = _state(
                    tree, geometry, of_bodies, solid, point, middle, own, t, side, stacks
                )
                if state == _OWN:
                    owns += 1
                elif state == _BEYOND:
                    if others == 0:
                        for axis in range(3):
                            beyond[axis] = point[axis]
                    others += 1
            begins[c, cell] = owns == 5
            if owns > 0 and others == 0:
                cell_row[c, cell] = i
            if owns > 0 or others == 0:
                continue
            nearest2 = _NEAR2 * texels.width[i] ** 2
            for k in range(9):
                row, beside = line + k // 3 - 1, column + k % 3 - 1
                if row < 0 or beside < 0 or row >= height or beside >= width:
                    continue
                j = texels.row_of[row, beside]
                if j < 0 or j == i or texels.pixel[j, 0] != beside or texels.pixel[j, 1] != row:
                    continue
                if side < 0.0:
                    j = texels.back[j]
                    if j == NOBODY:
                        continue
                other = _lifted(
                    geometry, texels, j, beside + 0.5, row + 0.5, weights, there, normal
                )
                away2 = 0.0
                for axis in range(3):
                    away2 += (there[axis] - beyond[axis]) ** 2
                if away2 >= nearest2 or dot(geometry.faces[other], geometry.faces[t]) < _ACROSS:
                    continue
                if not _apart(tree, geometry, solid, beyond, there, t, stacks[0], stacks[1]):
                    nearest2 = away2
                    cell_row[c, cell] = j

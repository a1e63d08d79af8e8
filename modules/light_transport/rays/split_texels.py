"""Texels that something stands across: walls go on beyond ceilings, sheets end on floors.

Light of one side must not get to the other. A texel that is cut belongs to the side of its middle:
rays begin there alone, and rays that meet it beyond take a neighbour's light. Texels with something
between them are no neighbours, so that neither patches nor smoothing go through walls, however thin
these are.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import dot, hot, inlined
from light_transport.rays.map_texels import (
    CELLS,
    NOBODY,
    PLACES,
    MapGeometry,
    Texels,
    ground_place,
    middle_of,
    place_at,
    surface_place,
    triangle_at,
)
from light_transport.rays.ray_starts import TURNS, across, evenly
from light_transport.rays.trace import FAR, MISS, nearest_within
from light_transport.rays.tree import STACK, Tree
from vrut_lite.numeric_types import Float32Array

# Height above the surface, in texels, at which obstacles between two places are found.
_ABOVE = np.float32(0.05)
# Largest cosine between an obstacle's normal and the surface's: bumps do not count.
_ACROSS = np.float32(0.9)
# Distance of a texel's corners from its edges, in texels.
_INSIDE = 1e-3
# The square of the farthest that a cell looks for a neighbour, in texels.
_NEAR2 = 4.0
# Where a point lies: in a body, on the side of its texel's middle, or beyond what cuts the texel.
_BURIED, _OWN, _BEYOND = 0, 1, 2
# Number of rays that decide whether a texel's middle lies in a body, and how many may meet backs.
_TOLD_BY, _MOST_BACKS = 8, 1
# Cells of a texel from its middle outwards.
_OUTWARDS = np.argsort(
    [
        (cell % CELLS - (CELLS - 1) / 2) ** 2 + (cell // CELLS - (CELLS - 1) / 2) ** 2
        for cell in range(CELLS * CELLS)
    ],
    kind="stable",
)
OverRows = Callable[[int, Callable[[int, int], None]], None]


def split_texels(
    tree: Tree,
    geometry: MapGeometry,
    texels: Texels,
    charts: NDArray[np.int32],
    links: NDArray[np.int32],
    sheets: NDArray[np.bool_],
    over_rows: OverRows,
) -> tuple[Texels, NDArray[np.int32]]:
    """The texels with what cuts them, and their links (N, 4) without those through walls.

    `charts` (N,) of texels; `sheets` (F,): triangles with two sides; `over_rows` does work on
    ranges of so many rows.
    """
    count = len(texels.pixel)
    solid = (tree.opacity >= 1.0)[geometry.leaf]
    solid &= np.isfinite(geometry.uv).all(axis=(1, 2)) | geometry.on_ground
    surfaces = charts, solid & ~sheets, solid
    crossed = np.zeros(count, bool)
    over_rows(
        count,
        lambda a, b: _crossed(tree, geometry, texels, solid, _stacks(), _places(), a, b, crossed),
    )
    cut = np.full(count, NOBODY, np.int32)
    rows = np.flatnonzero(crossed)
    cut[rows] = np.arange(len(rows), dtype=np.int32)
    middle = np.full((len(rows), 2), 0.5, np.float32)
    texels = texels._replace(cut=cut, middle=middle)
    over_rows(
        len(rows),
        lambda a, b: _middles(tree, geometry, texels, surfaces, rows, _stacks(), _places(), a, b),
    )
    cell_row = np.full((len(rows), CELLS * CELLS), NOBODY, np.int32)
    begins = texels.begins.copy()
    over_rows(
        len(rows),
        lambda a, b: _sides(
            tree,
            geometry,
            texels,
            surfaces,
            rows,
            _stacks(),
            _places(),
            (np.empty((CELLS + 1) ** 2, np.int8), np.empty(PLACES**2, np.int8)),
            a,
            b,
            cell_row,
            begins,
        ),
    )
    parted = np.zeros((count, 2), bool)
    over_rows(
        count,
        lambda a, b: _part(
            tree, geometry, texels, links, solid, _stacks(), _places(), a, b, parted
        ),
    )
    links = links.copy()
    for k, back, column in ((1, 0, 0), (3, 2, 1)):
        apart = np.flatnonzero(parted[:, column])
        links[links[apart, k], back] = NOBODY
        links[apart, k] = NOBODY
    return texels._replace(cell_row=cell_row, begins=begins), links


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
def apart(tree, geometry, solid, a, b, t, stacks):  # type: ignore[no-untyped-def]
    """Whether something stands across between two points (3,) above triangle t."""
    stack, far_stack = stacks
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


@inlined
def middle_place(geometry, texels, row, weights, place, normal):  # type: ignore[no-untyped-def]
    """`_lifted` of the place whose side a texel is of."""
    x, y = middle_of(texels, row)
    return _lifted(geometry, texels, row, x, y, weights, place, normal)


@hot
def _crossed(tree, geometry, texels, solid, stacks, places, first, last, crossed):  # type: ignore[no-untyped-def]
    """Which texels (N,) have something across one of their diagonals."""
    weights, a, b, normal, _, _ = places
    low, high = _INSIDE, 1.0 - _INSIDE
    for i in range(first, last):
        x, y = texels.pixel[i, 0], texels.pixel[i, 1]
        for k in range(2):
            left, right = (low, high) if k == 0 else (high, low)
            t = _lifted(geometry, texels, i, x + left, y + low, weights, a, normal)
            _lifted(geometry, texels, i, x + right, y + high, weights, b, normal)
            if apart(tree, geometry, solid, a, b, t, stacks):
                crossed[i] = True


@hot
def _middles(tree, geometry, texels, surfaces, rows, stacks, places, first, last):  # type: ignore[no-untyped-def]
    """Where middles of cut texels lie in bodies, move them to the nearest cell that does not."""
    weights, point, _, normal, _, _ = places
    _, of_bodies, _ = surfaces
    for c in range(first, last):
        i = rows[c]
        side = texels.side[i]
        t = middle_place(geometry, texels, i, weights, point, normal)
        if _is_free(tree, geometry, of_bodies, point, t, side, stacks):
            continue
        for cell in _OUTWARDS:
            x, y = (cell % CELLS + 0.5) / CELLS, (cell // CELLS + 0.5) / CELLS
            at_x, at_y = texels.pixel[i, 0] + x, texels.pixel[i, 1] + y
            t = _lifted(geometry, texels, i, at_x, at_y, weights, point, normal)
            if _is_free(tree, geometry, of_bodies, point, t, side, stacks):
                texels.middle[c, 0], texels.middle[c, 1] = x, y
                break


@inlined
def _is_free(tree, geometry, of_bodies, place, t, side, stacks):  # type: ignore[no-untyped-def]
    """Whether rays from a point (3,) above triangle t, spread by cosine, meet no backs of bodies.

    One may slip through a gap. In a body some rays meet fronts: other bodies end in it, as frames
    do in a wall.
    """
    stack, far_stack = stacks
    n = geometry.faces[t]
    sx, sy, sz, tx, ty, tz = across(n)
    backs = 0
    for k in range(_TOLD_BY):
        share, turn = (k + 0.5) / _TOLD_BY, 2.0 * math.pi * evenly(0.0, TURNS[0], k)
        up, level = side * math.sqrt(1.0 - share), math.sqrt(share)
        along, aside = level * math.cos(turn), level * math.sin(turn)
        x = up * n[0] + along * sx + aside * tx
        y = up * n[1] + along * sy + aside * ty
        z = up * n[2] + along * sz + aside * tz
        _, hit, _, _ = nearest_within(
            tree,
            np.float32(place[0]),
            np.float32(place[1]),
            np.float32(place[2]),
            np.float32(x),
            np.float32(y),
            np.float32(z),
            FAR,
            0,
            stack,
            far_stack,
        )
        if hit == MISS:
            continue
        met = tree.order[hit]
        face = geometry.faces[met]
        if of_bodies[met] and x * face[0] + y * face[1] + z * face[2] > 0.0:
            backs += 1
            if backs > _MOST_BACKS:
                return False
    return True


@hot
def _part(tree, geometry, texels, links, solid, stacks, places, first, last, parted):  # type: ignore[no-untyped-def]
    """Which texels have something before the one below and the one to the right (N, 2)."""
    weights, a, b, normal, _, _ = places
    for i in range(first, last):
        t = middle_place(geometry, texels, i, weights, a, normal)
        for k in range(2):
            j = links[i, 1 + 2 * k]
            if j != NOBODY:
                middle_place(geometry, texels, j, weights, b, normal)
                parted[i, k] = apart(tree, geometry, solid, a, b, t, stacks)


@inlined
def _state(tree, geometry, of_bodies, solid, place, middle, own, t, side, stacks):  # type: ignore[no-untyped-def]
    """Whether a point (3,) above triangle t lies in a body, on the side of a texel's `middle`, or
    beyond what cuts it; `own`: whether that middle is in no body."""
    stack, far_stack = stacks
    if own and not apart(tree, geometry, solid, middle, place, t, stacks):
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


@inlined
def _corner(column, line, number):  # type: ignore[no-untyped-def]
    """Where in the map a corner of a texel's cells lies, just inside the texel."""
    x, y = number % (CELLS + 1) / CELLS, number // (CELLS + 1) / CELLS
    low, high = _INSIDE, 1.0 - _INSIDE
    return column + min(max(x, low), high), line + min(max(y, low), high)


@hot
def _sides(  # type: ignore[no-untyped-def]
    tree, geometry, texels, surfaces, rows, stacks, places, states, first, last, cell_row, begins
):
    """Fill in the cells of cut texels, and where rays begin in them, by the states of their places.

    `states`, of the corners of cells (CELLS + 1)^2, which cells share, and of places (PLACES^2),
    are overwritten.
    """
    weights, middle, point, normal, there, beyond = places
    charts, of_bodies, solid = surfaces
    of_corner, of_place = states
    corners = len(of_corner)
    height, width = texels.row_of.shape
    for c in range(first, last):
        i = rows[c]
        column, line, side = texels.pixel[i, 0], texels.pixel[i, 1], texels.side[i]
        t = middle_place(geometry, texels, i, weights, middle, normal)
        own = (
            _state(tree, geometry, of_bodies, solid, middle, middle, False, t, side, stacks)
            != _BURIED
        )
        for k in range(corners + len(of_place)):
            if k < corners:
                x, y = _corner(column, line, k)
            else:
                x, y = place_at(texels, i, k - corners)
            _lifted(geometry, texels, i, x, y, weights, point, normal)
            state = _state(tree, geometry, of_bodies, solid, point, middle, own, t, side, stacks)
            if k < corners:
                of_corner[k] = state
                continue
            of_place[k - corners] = state
            if state != _OWN:
                begins[i] &= ~(np.uint64(1) << np.uint64(k - corners))
        for cell in range(CELLS * CELLS):
            owns, others = 0, 0
            for k in range(8):
                # Its places, then its corners.
                x, y = k % 2, k // 2 % 2
                if k < 4:
                    number = (2 * (cell // CELLS) + y) * PLACES + 2 * (cell % CELLS) + x
                    state = of_place[number]
                else:
                    number = (cell // CELLS + y) * (CELLS + 1) + cell % CELLS + x
                    state = of_corner[number]
                if state == _OWN:
                    owns += 1
                elif state == _BEYOND:
                    if others == 0:
                        if k < 4:
                            first_x, first_y = place_at(texels, i, number)
                        else:
                            first_x, first_y = _corner(column, line, number)
                    others += 1
            cell_row[c, cell] = i
            if owns >= others:
                continue
            _lifted(geometry, texels, i, first_x, first_y, weights, beyond, normal)
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
                middle_place(geometry, texels, j, weights, there, normal)
                away2 = 0.0
                for axis in range(3):
                    away2 += (there[axis] - beyond[axis]) ** 2
                if away2 >= nearest2 or charts[j] != charts[i]:
                    continue
                if not apart(tree, geometry, solid, beyond, there, t, stacks):
                    nearest2 = away2
                    cell_row[c, cell] = j

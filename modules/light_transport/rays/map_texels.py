"""The texels of a map that rays begin at: their places in the scene, and the sources of padding."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import cross, dot, inlined, kernel
from light_transport.layout.layout import Layout
from light_transport.rays.tree import Tree
from light_transport.surfaces.surfaces import GROUND, Surfaces
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

NOBODY = -1
# Cells along an edge of a texel that something stands across.
CELLS = 4
# Places along an edge of a texel that tell how much of it triangles cover, and where rays may begin
# in it: two a cell's edge, and a bit of 64 each.
PLACES = 2 * CELLS
ANYWHERE = np.uint64(2**64 - 1)
_LEAST_COVERED = 1.0 / 32.0
# One, and masks of every other bit, every other two, every other four; the lowest of each eight.
_ONE = np.uint64(1)
_PAIRS, _FOURS = np.uint64(0x5555555555555555), np.uint64(0x3333333333333333)
_EIGHTS, _EACH_EIGHT = np.uint64(0x0F0F0F0F0F0F0F0F), np.uint64(0x0101010101010101)
# Padding looks so far around for a texel to copy.
_REACH_PX = 2
# Length of normals in 16 bits: they are right to 3e-5 radians, and nobody needs their length.
_NORMAL = 32767.0
# Rays begin at least so far inside their triangle, of its height: not on an edge.
_INSIDE = 2e-4


class MapGeometry(NamedTuple):
    """Triangles in space and in the map, for kernels; lengths in radii of the scene.

    `triangle` (F, 9) float32: those of the tree, a corner and two edges; `leaf` (F,) int32: where
    each triangle is among these; `normals` (F, 3, 3) int16: of the corners, 32767 long; `faces`
    (F, 3) float32; `uv` (F, 3, 2) float32; `owner` (height, width); `on_ground` (F,) bool; `ground`
    (9,): corner of the ground's chart in the map (2), texels an edge less one, half width, warp,
    middle (2), height, and the warp's hyperbolic sine.
    """

    triangle: Float32Array
    leaf: NDArray[np.int32]
    normals: NDArray[np.int16]
    faces: Float32Array
    uv: Float32Array
    owner: NDArray[np.int32]
    on_ground: NDArray[np.bool_]
    ground: FloatArray


class Texels(NamedTuple):
    """Texels (N) that have rays, row by row, then their other sides where sheets have two.

    Attributes:
        pixel: (N, 2) int32, column and row in the map.
        triangle: (N,) int32, their owners.
        place: (N, 3) float32, in radii; normal: (N, 3) float32, the shading normal there.
        side: (N,) float32, 1 on fronts, -1 on backs; back: (N,) int32, the other side of a front,
            or NOBODY.
        area: (N,) float32, of the surface in them; width: (N,) float32, of a whole texel; radii.
        row_of: (height, width) int32, the number of each texel, for padding that of the texel
            that it copies, or NOBODY.
        cut: (N,) int32, the number of each among the texels (C) that something stands across, or
            NOBODY; `split_texels.py` finds them.
        cell_row: (C, CELLS^2) int32, whose light each cell of these shows: its own, or a
            neighbour's that most of the cell lies on the side of.
        middle: (C, 2) float32, where in the texel the place is whose side it is of.
        begins: (N,) uint64, a bit for each of PLACES^2 places, row by row: those that triangles
            cover and that lie on the texel's side. 0: at its middle alone.
    """

    pixel: NDArray[np.int32]
    triangle: NDArray[np.int32]
    place: Float32Array
    normal: Float32Array
    side: Float32Array
    back: NDArray[np.int32]
    area: Float32Array
    width: Float32Array
    row_of: NDArray[np.int32]
    cut: NDArray[np.int32]
    cell_row: NDArray[np.int32]
    middle: Float32Array
    begins: NDArray[np.uint64]


def map_geometry(surfaces: Surfaces, layout: Layout, tree: Tree) -> MapGeometry:
    """The arrays of surfaces and layout in the form and unit that kernels take."""
    radius = surfaces.radius_m
    chart = layout.message.ground
    ground = np.zeros(9)
    on_ground = surfaces.part == GROUND
    if chart is not None and np.any(on_ground):
        corners = surfaces.corners_m[on_ground]
        middle = 0.5 * (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1))) / radius
        half_width = chart.half_width_m / radius
        ground[:5] = *chart.corner_px, chart.edge_px - 1, half_width, chart.warp
        ground[5:] = middle[0], middle[2], middle[1], math.sinh(chart.warp)
    leaf = np.empty(len(tree.order), np.int32)
    leaf[tree.order] = np.arange(len(leaf), dtype=np.int32)
    return MapGeometry(
        tree.triangle,
        leaf,
        np.round(surfaces.normals * np.float32(_NORMAL)).astype(np.int16),
        surfaces.face_normals().astype(np.float32),
        np.ascontiguousarray(layout.uv_px, np.float32),
        np.ascontiguousarray(layout.owner),
        on_ground,
        ground,
    )


def edges_of(
    geometry: MapGeometry, triangles: NDArray[np.integer]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The first corner of triangles (K,) and the two edges that begin there, (K, 3) each."""
    found = geometry.triangle[geometry.leaf[triangles]].astype(np.float64)
    return found[:, :3], found[:, 3:6], found[:, 6:]


def texels_of(geometry: MapGeometry) -> Texels:
    """The texels that a triangle reaches into, and the texels that padding copies."""
    height, width = geometry.owner.shape
    covered, nearest, begins = _coverage(geometry)
    rows, columns = np.nonzero(covered > 0.0)
    pixel = np.ascontiguousarray(np.stack([columns, rows], axis=1), np.int32)
    place, normal, area = _places(geometry, pixel)
    row_of = np.full((height, width), NOBODY, np.int32)
    row_of[rows, columns] = np.arange(len(rows))
    _copied(geometry, nearest, place, normal, np.sqrt(area), row_of)
    return Texels(
        pixel,
        geometry.owner[rows, columns],
        place,
        normal,
        np.ones(len(pixel), np.float32),
        np.full(len(pixel), NOBODY, np.int32),
        (area * np.maximum(covered[rows, columns], _LEAST_COVERED)).astype(np.float32),
        np.sqrt(area).astype(np.float32),
        row_of,
        np.full(len(pixel), NOBODY, np.int32),
        np.empty((0, CELLS * CELLS), np.int32),
        np.empty((0, 2), np.float32),
        begins[rows, columns],
    )


def with_backs(texels: Texels, sheets: BoolArray) -> Texels:
    """These texels and the other sides of those that lie on sheets, by triangles (F,)."""
    fronts = np.flatnonzero(sheets[texels.triangle])
    back = np.full(len(texels.pixel) + len(fronts), NOBODY, np.int32)
    back[fronts] = len(texels.pixel) + np.arange(len(fronts), dtype=np.int32)

    def both(values: NDArray) -> NDArray:
        return np.concatenate([values, values[fronts]])

    return texels._replace(
        pixel=both(texels.pixel),
        triangle=both(texels.triangle),
        place=both(texels.place),
        normal=np.concatenate([texels.normal, -texels.normal[fronts]]),
        side=np.concatenate([texels.side, -texels.side[fronts]]),
        back=back,
        area=both(texels.area),
        width=both(texels.width),
        cut=both(texels.cut),
        begins=both(texels.begins),
    )


@inlined
def middle_of(texels, row):  # type: ignore[no-untyped-def]
    """The place in the map whose side a texel is of."""
    cut = texels.cut[row]
    x = texels.middle[cut, 0] if cut >= 0 else np.float32(0.5)
    y = texels.middle[cut, 1] if cut >= 0 else np.float32(0.5)
    return texels.pixel[row, 0] + x, texels.pixel[row, 1] + y


@inlined
def place_at(texels, row, place):  # type: ignore[no-untyped-def]
    """Where in the map one of a texel's PLACES^2 places lies."""
    return (
        texels.pixel[row, 0] + (place % PLACES + 0.5) / PLACES,
        texels.pixel[row, 1] + (place // PLACES + 0.5) / PLACES,
    )


@inlined
def has_place(begins, place):  # type: ignore[no-untyped-def]
    """Whether one of a texel's places is among those where rays begin."""
    return (begins >> np.uint64(place)) & np.uint64(1) != np.uint64(0)


@inlined
def beginning_at(texels, row, number, x, y):  # type: ignore[no-untyped-def]
    """A place in the map as it is, or the one of its texel's places that rays begin at instead.

    Where these are not all, it is the one about it, or else those with one `number` after another
    get one after another.
    """
    begins = texels.begins[row]
    if begins == ANYWHERE:
        return x, y
    column = min(max(int((x - texels.pixel[row, 0]) * PLACES), 0), PLACES - 1)
    line = min(max(int((y - texels.pixel[row, 1]) * PLACES), 0), PLACES - 1)
    place = line * PLACES + column
    if has_place(begins, place):
        return place_at(texels, row, place)
    some = _bits_set(begins)
    if some == 0:
        return middle_of(texels, row)
    left = begins
    for _ in range(number % some):
        left &= left - _ONE
    return place_at(texels, row, _bits_set((left & ~left + _ONE) - _ONE))


@inlined
def _bits_set(bits):  # type: ignore[no-untyped-def]
    """How many of 64 bits are set: sums of pairs, of fours, of eights, then of all."""
    bits -= bits >> _ONE & _PAIRS
    bits = (bits & _FOURS) + (bits >> np.uint64(2) & _FOURS)
    bits = bits + (bits >> np.uint64(4)) & _EIGHTS
    return np.int64(bits * _EACH_EIGHT >> np.uint64(56))


@inlined
def cell_at(texels, row, x, y):  # type: ignore[no-untyped-def]
    """The cell of a texel that is nearest to a place in the map."""
    column = min(max(int((x - texels.pixel[row, 0]) * CELLS), 0), CELLS - 1)
    line = min(max(int((y - texels.pixel[row, 1]) * CELLS), 0), CELLS - 1)
    return line * CELLS + column


@inlined
def weights_at(uv, t, x, y, weights):  # type: ignore[no-untyped-def]
    """Barycentric coordinates of a place in the map; whether it lies in triangle t."""
    ax, ay = uv[t, 0, 0], uv[t, 0, 1]
    bx, by = uv[t, 1, 0] - ax, uv[t, 1, 1] - ay
    cx, cy = uv[t, 2, 0] - ax, uv[t, 2, 1] - ay
    area = bx * cy - by * cx
    if area == 0.0:
        for k in range(3):
            weights[k] = 1.0 / 3.0
        return False
    px, py, inverse = x - ax, y - ay, 1.0 / area
    weights[1] = (px * cy - py * cx) * inverse
    weights[2] = (bx * py - by * px) * inverse
    weights[0] = 1.0 - weights[1] - weights[2]
    return weights[0] >= 0.0 and weights[1] >= 0.0 and weights[2] >= 0.0


@inlined
def keep_inside(uv, t, x, y, weights):  # type: ignore[no-untyped-def]
    """Barycentric coordinates of the point of triangle t that is nearest to a place in the map."""
    least = np.inf
    for e in range(3):
        f = (e + 1) % 3
        ax, ay = uv[t, e, 0], uv[t, e, 1]
        dx, dy = uv[t, f, 0] - ax, uv[t, f, 1] - ay
        length2 = dx * dx + dy * dy
        s = ((x - ax) * dx + (y - ay) * dy) / length2 if length2 > 0.0 else 0.0
        s = min(max(s, 0.0), 1.0)
        away2 = (ax + s * dx - x) ** 2 + (ay + s * dy - y) ** 2
        if away2 < least:
            least = away2
            weights[e], weights[f], weights[(e + 2) % 3] = 1.0 - s, s, 0.0


@inlined
def keep_off_edges(weights):  # type: ignore[no-untyped-def]
    """Move barycentric coordinates just inside their triangle."""
    for k in range(3):
        weights[k] = max(weights[k], _INSIDE)
    inverse = 1.0 / (weights[0] + weights[1] + weights[2])
    for k in range(3):
        weights[k] *= inverse


@inlined
def triangle_at(geometry, column, row, x, y, weights):  # type: ignore[no-untyped-def]
    """A triangle at a place in a texel and barycentric coordinates there, inside it.

    The texel's owner, one of the texels' beside it, or the owner's point that is nearest.
    """
    uv, owner = geometry.uv, geometry.owner
    height, width = owner.shape
    own = owner[row, column]
    found = own if weights_at(uv, own, x, y, weights) else NOBODY
    last = own
    for k in range(9):
        if found >= 0:
            break
        r, c = row + k // 3 - 1, column + k % 3 - 1
        if 0 <= r < height and 0 <= c < width:
            t = owner[r, c]
            if t >= 0 and t != own and t != last:
                last = t
                if weights_at(uv, t, x, y, weights):
                    found = t
    if found < 0:
        found = own
        keep_inside(uv, own, x, y, weights)
    keep_off_edges(weights)
    return found


@inlined
def ground_place(ground, x, y, place):  # type: ignore[no-untyped-def]
    """The point of the ground at a place in the map; see `GroundChart`."""
    for axis in range(2):
        at = ((x if axis == 0 else y) - ground[axis] - 0.5) / ground[2] * 2.0 - 1.0
        away = math.sinh(ground[4] * at) / ground[8]
        away = min(max(away, -1.0), 1.0) * 0.999
        place[2 * axis] = ground[5 + axis] + ground[3] * away
    place[1] = ground[7]


@inlined
def ground_at(ground, away, axis):  # type: ignore[no-untyped-def]
    """Where a point of the ground lies in the map, along one of its axes."""
    away = (away - ground[5 + axis]) / ground[3]
    # The inverse hyperbolic sine; the library's takes twice as long.
    warped = ground[8] * min(abs(away), 1.0)
    away = math.copysign(math.log(warped + math.sqrt(warped * warped + 1.0)) / ground[4], away)
    return ground[axis] + 0.5 + 0.5 * (1.0 + away) * ground[2]


@inlined
def surface_place(geometry, t, weights, place, normal):  # type: ignore[no-untyped-def]
    """The point of triangle t at barycentric coordinates, and the shading normal there."""
    triangle, normals, leaf = geometry.triangle, geometry.normals, geometry.leaf[t]
    for k in range(3):
        place[k] = (
            triangle[leaf, k]
            + weights[1] * triangle[leaf, 3 + k]
            + weights[2] * triangle[leaf, 6 + k]
        )
        normal[k] = (
            weights[0] * normals[t, 0, k]
            + weights[1] * normals[t, 1, k]
            + weights[2] * normals[t, 2, k]
        )
    length = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    inverse = 1.0 / length
    for k in range(3):
        normal[k] = normal[k] * inverse if length > 1e-6 * _NORMAL else geometry.faces[t, k]


@kernel
def _coverage(geometry):  # type: ignore[no-untyped-def]
    """Share of each texel that triangles cover, the place (2) in the map that it stands for, and
    which of its places they cover."""
    owner, uv = geometry.owner, geometry.uv
    height, width = owner.shape
    covered = np.zeros((height, width), np.float32)
    begins = np.full((height, width), ANYWHERE)
    nearest = np.zeros((height, width, 2), np.float32)
    weights = np.empty(3)
    for row in range(height):
        for column in range(width):
            t = owner[row, column]
            if t < 0:
                continue
            x, y = column + 0.5, row + 0.5
            nearest[row, column, 0], nearest[row, column, 1] = x, y
            if geometry.on_ground[t]:
                covered[row, column] = 1.0
                continue
            if not weights_at(uv, t, x, y, weights):
                keep_inside(uv, t, x, y, weights)
                for k in range(2):
                    nearest[row, column, k] = (
                        weights[0] * uv[t, 0, k]
                        + weights[1] * uv[t, 1, k]
                        + weights[2] * uv[t, 2, k]
                    )
            away_x, away_y = nearest[row, column, 0] - x, nearest[row, column, 1] - y
            if max(abs(away_x), abs(away_y)) > 0.5:
                continue
            corners = 0
            for k in range(4):
                corners += weights_at(uv, t, column + k % 2, row + k // 2, weights)
            if corners == 4:
                covered[row, column] = 1.0
                continue
            bits, pieces = np.uint64(0), 0
            for k in range(PLACES * PLACES):
                px = column + (k % PLACES + 0.5) / PLACES
                py = row + (k // PLACES + 0.5) / PLACES
                inside = weights_at(uv, t, px, py, weights)
                for side in range(9):
                    if inside:
                        break
                    r, c = row + side // 3 - 1, column + side % 3 - 1
                    if r < 0 or c < 0 or r >= height or c >= width:
                        continue
                    other = owner[r, c]
                    inside = other >= 0 and other != t and weights_at(uv, other, px, py, weights)
                if inside:
                    bits |= np.uint64(1) << np.uint64(k)
                    pieces += 1
            covered[row, column] = max(pieces / (PLACES * PLACES), 1e-3)
            if pieces > 0:
                begins[row, column] = bits
    return covered, nearest, begins


@kernel
def _places(geometry, pixel):  # type: ignore[no-untyped-def]
    """Point, normal and area of whole texels."""
    count = len(pixel)
    place, normal = np.empty((count, 3), np.float32), np.empty((count, 3), np.float32)
    area = np.empty(count, np.float32)
    weights, beside = np.empty(3), np.empty(3)
    b, c = np.empty(3, np.float32), np.empty(3, np.float32)
    uv, triangle = geometry.uv, geometry.triangle
    for i in range(count):
        column, row = pixel[i, 0], pixel[i, 1]
        t = geometry.owner[row, column]
        if geometry.on_ground[t]:
            size = 1.0
            for axis in range(2):
                at = (column, row)[axis] + 0.5
                ground_place(geometry.ground, at - 0.5, at - 0.5, beside)
                low = beside[2 * axis]
                ground_place(geometry.ground, at + 0.5, at + 0.5, beside)
                size *= max(beside[2 * axis] - low, 1e-9)
            ground_place(geometry.ground, column + 0.5, row + 0.5, beside)
            for k in range(3):
                place[i, k], normal[i, k] = beside[k], geometry.faces[t, k]
            area[i] = size
            continue
        t = triangle_at(geometry, column, row, column + 0.5, row + 0.5, weights)
        surface_place(geometry, t, weights, place[i], normal[i])
        for k in range(3):
            b[k], c[k] = triangle[geometry.leaf[t], 3 + k], triangle[geometry.leaf[t], 6 + k]
        cross(b, c, beside)
        ux, uy = uv[t, 1, 0] - uv[t, 0, 0], uv[t, 1, 1] - uv[t, 0, 1]
        vx, vy = uv[t, 2, 0] - uv[t, 0, 0], uv[t, 2, 1] - uv[t, 0, 1]
        flat = abs(ux * vy - uy * vx)
        area[i] = math.sqrt(dot(beside, beside)) / flat if flat > 0.0 else 0.0
    return place, normal, area


@kernel
def _copied(geometry, nearest, place, normal, texel_width, row_of):  # type: ignore[no-untyped-def]
    """Fill in the source of padding: the nearest texel around it that faces the same way."""
    owner = geometry.owner
    height, width = owner.shape
    own = row_of.copy()
    weights, here, facing = np.empty(3), np.empty(3), np.empty(3)
    for row in range(height):
        for column in range(width):
            t = owner[row, column]
            if t < 0 or own[row, column] >= 0:
                continue
            x, y = nearest[row, column, 0], nearest[row, column, 1]
            keep_inside(geometry.uv, t, x, y, weights)
            surface_place(geometry, t, weights, here, facing)
            best = np.inf
            for r in range(max(row - _REACH_PX, 0), min(row + _REACH_PX + 1, height)):
                for c in range(max(column - _REACH_PX, 0), min(column + _REACH_PX + 1, width)):
                    other = own[r, c]
                    if other < 0:
                        continue
                    away2, alike = 0.0, 0.0
                    for k in range(3):
                        away2 += (place[other, k] - here[k]) ** 2
                        alike += normal[other, k] * facing[k]
                    away2 += (1.0 - alike) * texel_width[other] ** 2
                    if away2 < best:
                        best = away2
                        row_of[row, column] = other

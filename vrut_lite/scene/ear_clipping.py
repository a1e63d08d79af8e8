"""Triangles of concave polygons, by ear clipping (Meisters 1975, Am. Math. Monthly 82, 648)."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.njit import njit
from vrut_lite.numeric_types import BoolArray, FloatArray

# Sine of a turn to the wrong side from which a polygon is concave; files round positions.
_CONCAVE = 1e-6
# Corners looked at together.
_CHUNK = 2**18
# Tests of points in triangles, for all polygons of a file: some seconds. Past them polygons are
# cut as fans, so that no file takes for ever.
_MOST_TESTS = 2_000_000_000


def fans(counts: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Fans of triangles (F, 3) of polygons, as numbers of corners, and the polygon (F,) of each."""
    starts = np.cumsum(counts) - counts
    triangles = np.maximum(counts - 2, 0)
    face = np.repeat(np.arange(len(counts)), triangles)
    within = np.arange(triangles.sum()) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    first = starts[face]
    return np.stack([first, first + within + 1, first + within + 2], axis=1), face


def polygon_corners(
    points: FloatArray, counts: NDArray[np.int64], indices: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Triangles (F, 3) of polygons, as numbers of corners, and the polygon (F,) of each.

    The polygons have `counts` corners each, which name the points `indices`, one after another.

    Raises:
        ValueError: an index is outside the points (V, 3).
    """
    if len(indices) and not (indices.min() >= 0 and indices.max() < len(points)):
        raise ValueError(f"a face names vertex {indices.max():,} of {len(points):,}")
    corners, face = fans(counts)
    continues = np.diff(face, prepend=-1) == 0
    return ear_clipped(corners, continues, lambda ring: points[indices[ring]]), face


def ear_clipped(
    corners: NDArray[Any],
    continues: BoolArray,
    places_of: Callable[[NDArray[Any]], FloatArray],
) -> NDArray[Any]:
    """Triangles (F, 3, ...), with those of concave polygons replaced by ear clipping.

    Args:
        corners: fans of polygons, each about its polygon's first corner, in order.
        continues: (F,) whether a triangle is of the same polygon as the one before it.
        places_of: the positions (..., 3) of corners (..., ...).
    """
    starts = np.flatnonzero(~continues)
    sizes = np.diff(np.append(starts, len(corners)))
    tests_left = np.array([_MOST_TESTS])
    for size in np.unique(sizes[sizes > 1]):
        first = starts[sizes == size]
        for part in np.array_split(first, 1 + first.size * (size + 2) // _CHUNK):
            rows = part[:, None] + np.arange(size)
            ring = np.concatenate([corners[part, :2], corners[rows, 2]], axis=1)
            places = places_of(ring)
            normals = _normals(places)
            for number in np.flatnonzero(_is_concave(places, normals)):
                cut = clip_ears(_flat(places[number], normals[number]), tests_left)
                corners[rows[number]] = ring[number][cut]
    return corners


def _normals(places: FloatArray) -> FloatArray:
    """Normals (m, 3) of polygons (m, k, 3), twice as long as their areas (M. Newell)."""
    around = places - places[:, :1]
    return np.asarray(np.cross(around, np.roll(around, -1, axis=1)).sum(axis=1))


def _is_concave(places: FloatArray, normals: FloatArray) -> BoolArray:
    """Whether polygons (m, k, 3) turn to the wrong side (m,) somewhere."""
    onward = np.roll(places, -1, axis=1) - places
    before = np.roll(onward, 1, axis=1)
    turn = np.einsum("mkc,mc->mk", np.cross(before, onward), normals)
    lengths = np.linalg.norm(before, axis=2) * np.linalg.norm(onward, axis=2)
    concave = turn < -_CONCAVE * lengths * np.linalg.norm(normals, axis=1)[:, None]
    return np.asarray(concave.any(axis=1))


def _flat(places: FloatArray, normal: FloatArray) -> FloatArray:
    """A polygon (k, 2) along the axis that its normal follows most, seen counter-clockwise."""
    axis = int(np.argmax(np.abs(normal)))
    flat = places[:, [(axis + 1) % 3, (axis + 2) % 3]] - places[0, [(axis + 1) % 3, (axis + 2) % 3]]
    return np.ascontiguousarray(flat if normal[axis] > 0.0 else flat[:, ::-1])


@njit(cache=True, nogil=True)
def clip_ears(flat: FloatArray, tests_left: NDArray[np.int64]) -> NDArray[np.int64]:
    """Corners (k - 2, 3) of the triangles of a simple polygon (k, 2), counter-clockwise.

    Holes may be joined to the outline by seams. Where no corner is an ear, as in a polygon that
    crosses itself, the next one is cut.
    """
    count = len(flat)
    after = (np.arange(count) + 1) % count
    before = (np.arange(count) - 1) % count
    triangles = np.empty((count - 2, 3), np.int64)
    at, found, tried, allows_flat = 0, 0, 0, False
    while found < count - 2:
        start, end = before[at], after[at]
        is_lost = tests_left[0] < 0 or (allows_flat and tried >= count - found)
        if not (is_lost or _is_ear(flat, start, at, end, after, allows_flat, tests_left)):
            at = end
            tried += 1
            if tried >= count - found and not allows_flat:
                allows_flat, tried = True, 0
            continue
        triangles[found, 0], triangles[found, 1], triangles[found, 2] = start, at, end
        found += 1
        after[start], before[end] = end, start
        at, tried, allows_flat = after[end], 0, False
    return triangles


@njit(cache=True, nogil=True)
def _turn(flat: FloatArray, a: int, b: int, c: int) -> float:
    """Twice the area of a triangle, positive if it is counter-clockwise."""
    return (flat[b, 0] - flat[a, 0]) * (flat[c, 1] - flat[a, 1]) - (flat[b, 1] - flat[a, 1]) * (
        flat[c, 0] - flat[a, 0]
    )


@njit(cache=True, nogil=True)
def _is_same(flat: FloatArray, a: int, b: int) -> bool:
    return flat[a, 0] == flat[b, 0] and flat[a, 1] == flat[b, 1]


@njit(cache=True, nogil=True)
def _is_ear(
    flat: FloatArray,
    start: int,
    at: int,
    end: int,
    after: NDArray[np.int64],
    allows_flat: bool,
    tests_left: NDArray[np.int64],
) -> bool:
    """Whether a corner and its neighbours are a triangle with no other corner in it."""
    area = _turn(flat, start, at, end)
    if area < 0.0 or (area == 0.0 and not allows_flat):
        return False
    other = after[end]
    while other != start:
        tests_left[0] -= 1
        inside = (
            _turn(flat, start, at, other) >= 0.0
            and _turn(flat, at, end, other) >= 0.0
            and _turn(flat, end, start, other) >= 0.0
        )
        # Ends of a seam lie at one place.
        ends = (
            _is_same(flat, other, start) or _is_same(flat, other, at) or _is_same(flat, other, end)
        )
        if inside and not ends:
            return False
        other = after[other]
    return True

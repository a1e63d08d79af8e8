"""Vertex normals for meshes without them: smooth over bends, split at creases."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.connected import connected_components
from vrut_lite.numeric_types import FloatArray, IntArray

CREASE_ANGLE_RAD = np.radians(40.0)
_BLOCK = 2**15
# For each corner of a triangle, the next and the previous one.
_NEXT, _LAST = [1, 2, 0], [2, 0, 1]


def crease_normals(
    vertices: FloatArray, faces: IntArray, crease_angle_rad: float = CREASE_ANGLE_RAD
) -> tuple[IntArray, IntArray, FloatArray]:
    """Split vertices along edges sharper than the crease angle and give each a unit normal.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) vertex indices, counter-clockwise seen from outside.
        crease_angle_rad: angle between face normals above which an edge stays sharp.

    Returns:
        source (N,): the old vertex that each new one copies; the new faces (F, 3); the new
        vertices' normals (N, 3), weighted by the corner's angle (Thürmer and Wüthrich 1998).
        The normal of a vertex with only degenerate triangles points up.
    """
    face_normals = _face_normals(vertices, faces)
    group = _smooth_corners(_places(vertices)[faces], face_normals, np.cos(crease_angle_rad))
    normals = _summed_normals(group, face_normals, _corner_angles(vertices, faces))
    # One number for each pair of an old vertex and a group, which sorts as the pair does.
    pairs, corner = np.unique(faces.reshape(-1) * len(normals) + group, return_inverse=True)
    source, group = np.divmod(pairs, len(normals))
    return source, corner.reshape(faces.shape), normals[group]


def unit_or_none(normals: FloatArray) -> FloatArray | None:
    """Unit normals (V, 3), or None if one of them has no direction."""
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    if not np.all(np.isfinite(length)) or np.any(length < 1e-6):
        return None
    return np.asarray(normals / length)


def _face_normals(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Unit normals (F, 3); zero for degenerate triangles."""
    normals = np.zeros(faces.shape)
    for block in _blocks(len(faces)):
        a, b, c = np.moveaxis(vertices[faces[block]], 1, 0)
        normal = np.cross(b - a, c - a)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        np.divide(normal, length, out=normals[block], where=length > 0)
    return normals


def _corner_angles(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """The angle (F, 3) of each triangle at each corner, rad."""
    angles = np.empty(faces.shape)
    for block in _blocks(len(faces)):
        corner = vertices[faces[block]]
        onward, back = corner[:, _NEXT] - corner, corner[:, _LAST] - corner
        sine = np.linalg.norm(np.cross(onward, back), axis=2)
        np.arctan2(sine, np.sum(onward * back, axis=2), out=angles[block])
    return angles


def _blocks(count: int) -> Iterator[slice]:
    """Slices of `_BLOCK` items, so that temporary arrays stay small enough for the cache."""
    for start in range(0, count, _BLOCK):
        yield slice(start, start + _BLOCK)


def _places(vertices: FloatArray) -> IntArray:
    """A number (V,) for each vertex, the same for those at the same position."""
    order = np.lexsort(vertices.T[::-1])
    place = np.zeros(len(vertices), dtype=np.int64)
    last, first = vertices[order[1:]], vertices[order[:-1]]
    place[order[1:]] = np.cumsum(np.any(last != first, axis=1))
    return place


def _smooth_corners(place: IntArray, face_normals: FloatArray, least_cosine: float) -> IntArray:
    """Group number (3F,) of each corner: corners of one place joined over smooth edges.

    Edges are matched by place, so that seams in texture coordinates do not show.
    """
    first, second = _smooth_links(place, face_normals, least_cosine)
    return connected_components(place.size, first, second)


def _smooth_links(
    place: IntArray, face_normals: FloatArray, least_cosine: float
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Pairs of corners to join: both ends of every smooth edge, in its two faces.

    An edge has the number of the corner it begins at; face f has 3 f, 3 f + 1, 3 f + 2.
    """
    end = place[:, _NEXT]
    flipped = (place > end).reshape(-1)
    edge = (np.minimum(place, end) * (int(place.max()) + 1) + np.maximum(place, end)).reshape(-1)
    order = np.argsort(edge, kind="stable").astype(np.int32)
    edge = edge[order]
    same = np.flatnonzero(edge[1:] == edge[:-1]).astype(np.int32)
    del edge, end
    smooth = np.empty(len(same), bool)
    for block in _blocks(len(same)):
        faces = order[same[block]] // 3, order[same[block] + 1] // 3
        cosine = np.sum(face_normals[faces[1]] * face_normals[faces[0]], axis=1)
        smooth[block] = cosine >= least_cosine
    joined = same[smooth]
    first, second = (_ends(corner, flipped) for corner in (order[joined], order[joined + 1]))
    return first, second


def _ends(corner: NDArray[np.int32], flipped: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Both ends (2n,) of edges, as corners: that of the lower place first."""
    onward = np.where(corner % 3 == 2, corner - 2, corner + 1)
    turned = flipped[corner]
    ends = np.where(turned, onward, corner), np.where(turned, corner, onward)
    return np.concatenate(ends)


def _summed_normals(group: IntArray, face_normals: FloatArray, weight: FloatArray) -> FloatArray:
    """Unit normal (groups, 3) of each group of corners."""
    axes = [
        np.bincount(group, (face_normals[:, axis, None] * weight).reshape(-1)) for axis in range(3)
    ]
    total = np.stack(axes, axis=1)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    up = np.broadcast_to([0.0, 1.0, 0.0], total.shape).copy()
    return np.divide(total, length, out=up, where=length > 0)

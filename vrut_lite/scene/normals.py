"""Vertex normals for meshes that bring none: smooth where the surface bends, split at creases."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

CREASE_ANGLE_RAD = np.radians(40.0)
FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def crease_normals(
    vertices: FloatArray, faces: IntArray, crease_angle_rad: float = CREASE_ANGLE_RAD
) -> tuple[IntArray, IntArray, FloatArray]:
    """Split vertices along edges sharper than the crease angle and give each a unit normal.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) vertex indices, counter-clockwise seen from outside.
        crease_angle_rad: angle between face normals above which an edge stays sharp.

    Returns:
        source (N,): which old vertex each new one copies; the new faces (F, 3); the new
        vertices' normals (N, 3), weighted by the corner's angle (Thürmer and Wüthrich 1998).
        A vertex of degenerate triangles only points up.
    """
    face_normals = _face_normals(vertices, faces)
    place = np.unique(vertices, axis=0, return_inverse=True)[1].reshape(-1)[faces]
    group = _smooth_corners(place, face_normals, np.cos(crease_angle_rad))
    normals = _summed_normals(group, face_normals, _corner_angles(vertices, faces))
    pairs = np.stack([faces.reshape(-1), group], axis=1)
    unique_pairs, corner = np.unique(pairs, axis=0, return_inverse=True)
    return unique_pairs[:, 0], corner.reshape(faces.shape), normals[unique_pairs[:, 1]]


def unit_or_none(normals: FloatArray) -> FloatArray | None:
    """Unit normals (V, 3), or None if one of them has no direction."""
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    if not np.all(np.isfinite(length)) or np.any(length < 1e-6):
        return None
    return np.asarray(normals / length)


def _face_normals(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Unit normals (F, 3); zero for degenerate triangles."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)


def _corner_angles(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """The angle (F, 3) of each triangle at each corner, rad."""
    corner = vertices[faces]
    onward, back = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    sine = np.linalg.norm(np.cross(onward, back), axis=2)
    return np.arctan2(sine, np.sum(onward * back, axis=2))


def _smooth_corners(place: IntArray, face_normals: FloatArray, least_cosine: float) -> IntArray:
    """Group number (3F,) of each corner: corners of one place joined over smooth edges.

    Edges are matched by place, so that seams in texture coordinates do not show.
    """
    corner = np.arange(place.size).reshape(place.shape)
    ends = np.stack([place, np.roll(place, -1, axis=1)], axis=-1).reshape(-1, 2)
    corners = np.stack([corner, np.roll(corner, -1, axis=1)], axis=-1).reshape(-1, 2)
    flipped = ends[:, 0] > ends[:, 1]
    ends[flipped], corners[flipped] = ends[flipped, ::-1], corners[flipped, ::-1]
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, corners = ends[order], corners[order]
    face = corners[:, 0] // 3
    cosine = np.sum(face_normals[face[1:]] * face_normals[face[:-1]], axis=1)
    join = np.all(ends[1:] == ends[:-1], axis=1) & (cosine >= least_cosine)
    first, second = corners[:-1][join].reshape(-1), corners[1:][join].reshape(-1)
    links = coo_matrix((np.ones(first.size, bool), (first, second)), (place.size, place.size))
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.int64)


def _summed_normals(group: IntArray, face_normals: FloatArray, weight: FloatArray) -> FloatArray:
    """Unit normal (groups, 3) of each group of corners."""
    total = np.zeros((int(group.max()) + 1, 3))
    np.add.at(total, group, (face_normals[:, None, :] * weight[:, :, None]).reshape(-1, 3))
    length = np.linalg.norm(total, axis=1, keepdims=True)
    up = np.broadcast_to([0.0, 1.0, 0.0], total.shape).copy()
    return np.divide(total, length, out=up, where=length > 0)

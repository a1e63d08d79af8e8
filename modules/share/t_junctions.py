"""Edges of triangles split where other triangles have vertices on them.

Two edges along one line that end in different places round to different pixels: between them the
background shines through. Edges with the same ends do not.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from share.scene_mesh import MeshGroup
from vrut_lite.numeric_types import Float32Array, FloatArray

# Probes along an edge are a scene's size over this apart: few vertices lie near each.
_PROBES = 300


def without_t_junctions(groups: list[MeshGroup], step_m: float) -> list[MeshGroup]:
    """The groups, edges split at vertices of all groups that lie within `step_m` of them."""
    points = np.unique(np.concatenate([group.positions_m for group in groups]), axis=0)
    tree = cKDTree(points)
    reach_m = float(np.ptp(points, axis=0).max()) / _PROBES
    return [_split(group, points, tree, step_m, max(reach_m, step_m)) for group in groups]


def _split(
    group: MeshGroup, points: Float32Array, tree: cKDTree, step_m: float, reach_m: float
) -> MeshGroup:
    done = []
    triangles = group.triangles
    # Each round splits triangles at one vertex; their halves may have more.
    while len(triangles):
        triangle, corner, point = _first_on_edges(
            group.positions_m[triangles].astype(float), points, tree, step_m, reach_m
        )
        done.append(np.delete(triangles, triangle, axis=0))
        a, b, c = (triangles[triangle, (corner + k) % 3] for k in range(3))
        new = np.arange(len(point), dtype=np.uint32) + np.uint32(len(group.positions_m))
        group = _with_vertices(group, a, b, points[point])
        triangles = np.concatenate([np.stack([a, new, c], axis=1), np.stack([new, b, c], axis=1)])
    return replace(group, triangles=np.concatenate([*done, triangles]))


def _first_on_edges(
    corners: FloatArray, points: Float32Array, tree: cKDTree, step_m: float, reach_m: float
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Triangles (n,) of corners (F, 3, 3) with a point on an edge, the corner that begins the
    edge, and the point."""
    begin, along = corners.reshape(-1, 3), (np.roll(corners, -1, axis=1) - corners).reshape(-1, 3)
    length = np.linalg.norm(along, axis=1)
    count = np.ceil(length / reach_m).astype(np.intp)
    edge = np.repeat(np.arange(len(count)), count)
    number = np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)
    share = (number + 0.5) / count[edge]
    near = tree.query_ball_point(
        begin[edge] + share[:, None] * along[edge], 0.5 * length[edge] / count[edge] + step_m
    )
    edge = np.repeat(edge, [len(found) for found in near])
    point = np.fromiter((one for found in near for one in found), np.intp, len(edge))
    away = points[point] - begin[edge]
    metres = np.einsum("ij,ij->i", away, along[edge]) / length[edge]
    aside = np.linalg.norm(away - (metres / length[edge])[:, None] * along[edge], axis=1)
    on = (aside < step_m) & (metres > 2.0 * step_m) & (metres < length[edge] - 2.0 * step_m)
    triangle, first = np.unique(edge[on] // 3, return_index=True)
    return triangle, edge[on][first] % 3, point[on][first]


def _with_vertices(
    group: MeshGroup, a: NDArray[np.uint32], b: NDArray[np.uint32], places: Float32Array
) -> MeshGroup:
    """The group with vertices at places (n, 3) on the edges from vertices `a` to `b`."""
    begin, along = group.positions_m[a], group.positions_m[b] - group.positions_m[a]
    share = np.sum((places - begin) * along, axis=1) / np.sum(along * along, axis=1)

    def longer(values: Float32Array | None) -> Float32Array | None:
        if values is None:
            return None
        mixed = values[a] + share[:, None] * (values[b] - values[a])
        return np.concatenate([values, mixed.astype(np.float32)])

    normals = longer(group.normals)
    assert normals is not None
    return replace(
        group,
        positions_m=np.concatenate([group.positions_m, places]),
        normals=normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30),
        uv=longer(group.uv),
        second_uv=longer(group.second_uv),
        light_px=longer(group.light_px),
        colours=longer(group.colours),
    )

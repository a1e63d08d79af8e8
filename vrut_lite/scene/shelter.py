"""Finds rooms without daylight: closed bodies around the eye."""

from typing import NamedTuple

import numpy as np
import trimesh
from numpy.typing import ArrayLike, NDArray

from vrut_lite.scene.loading import LoadedScene

# Larger scenes count as open: the search would cost more than it saves.
_MOST_TRIANGLES = 200_000
_WHOLE_TURN = 0.99


class _Body(NamedTuple):
    """Triangles (F, 3, 3) that enclose a volume; `both_sides`: all are double-sided."""

    triangles: NDArray[np.float64]
    both_sides: bool
    lower_m: NDArray[np.float64]
    upper_m: NDArray[np.float64]


class Shelter:
    """The closed bodies of a scene, made of opaque triangles that meet edge to edge.

    A body with any gap counts as open, and so does one whose edges meet only in part: a closed
    room may be missed, an open one is never called closed.
    """

    def __init__(self, scene: LoadedScene):
        self._bodies: list[_Body] = []
        opaque = [(p, p.mesh.visual.material) for p in scene.meshes]  # type: ignore[union-attr]
        opaque = [(p, material) for p, material in opaque if material.alphaMode == "OPAQUE"]
        if not opaque or scene.triangles > _MOST_TRIANGLES:
            return
        both_sides = [np.full(len(p.mesh.faces), bool(m.doubleSided)) for p, m in opaque]
        triangles = [p.world_triangles() for p, _ in opaque]
        self._bodies = _closed_bodies(np.concatenate(triangles), np.concatenate(both_sides))

    def holds(self, point_m: ArrayLike) -> bool:
        """Whether a point (3,) is in a closed body whose inside is visible in all directions."""
        point = np.asarray(point_m, dtype=float)
        return any(_closes_around(body, point) for body in self._bodies)


def _closed_bodies(triangles: NDArray[np.float64], both_sides: NDArray[np.bool_]) -> list[_Body]:
    welded = trimesh.Trimesh(
        vertices=triangles.reshape(-1, 3),
        faces=np.arange(3 * len(triangles)).reshape(-1, 3),
        process=False,
    )
    welded.merge_vertices()
    groups = trimesh.graph.connected_components(
        welded.face_adjacency, nodes=np.arange(len(triangles)), min_len=4
    )
    bodies = []
    for faces in groups:
        if _is_closed(np.asarray(welded.faces)[faces]):
            body = triangles[faces]
            bounds = body.min(axis=(0, 1)), body.max(axis=(0, 1))
            bodies.append(_Body(body, bool(both_sides[faces].all()), *bounds))
    return bodies


def _is_closed(faces: NDArray[np.int64]) -> bool:
    """Whether every edge occurs exactly once in each direction: no gap, one orientation."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    there = edges[np.lexsort(edges.T)]
    back = edges[:, ::-1]
    back = back[np.lexsort(back.T)]
    alone = bool(np.all(np.any(there[1:] != there[:-1], axis=1)))
    return alone and bool(np.array_equal(there, back))


def _closes_around(body: _Body, point: NDArray[np.float64]) -> bool:
    """Whether the body surrounds the point, by the solid angle of all its triangles.

    In units of 4 pi it is -1 if they face the point, 1 if they face away from it.
    Van Oosterom and Strackee 1983, "The Solid Angle of a Plane Triangle".
    """
    if np.any(point < body.lower_m) or np.any(point > body.upper_m):
        return False
    a, b, c = np.moveaxis(body.triangles - point, 1, 0)
    la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    triple = np.einsum("fi,fi->f", a, np.cross(b, c))
    dots = [np.einsum("fi,fi->f", u, v) for u, v in ((a, b), (b, c), (c, a))]
    turns = np.sum(np.arctan2(triple, la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb))
    turns = turns / (2 * np.pi)
    return bool(turns < -_WHOLE_TURN or (body.both_sides and turns > _WHOLE_TURN))

"""Edges of a page's meshes that lie along one another have the same ends."""

from dataclasses import replace

import numpy as np
import pytest
from share.scene_mesh import MeshGroup
from share.t_junctions import without_t_junctions

STEP_M = 1e-3


def group(corners, triangles):
    places = np.array(corners, np.float32)
    normals = np.broadcast_to(np.array([0.0, 1.0, 0.0], np.float32), places.shape)
    uv = places[:, [0, 2]] * np.float32(0.5)
    return MeshGroup(0, places, normals, uv, None, uv + 3.0, None, np.array(triangles, np.uint32))


@pytest.fixture
def floor_and_wall():
    """A floor whose far edge lies along the foot of a wider wall with a vertex in its middle."""
    floor = group([[-3, 0, 0], [3, 0, 0], [3, 0, 7], [-3, 0, 7]], [[0, 2, 1], [0, 3, 2]])
    wall = group(
        [[-4, 0, 7], [1, 0, 7], [4, 0, 7], [4, 5, 7], [-4, 5, 7]], [[0, 1, 4], [1, 3, 4], [1, 2, 3]]
    )
    return [floor, wall]


def inner_vertices(groups):
    """Vertices that lie inside edges, one by one: the slow twin."""
    points = np.concatenate([one.positions_m for one in groups]).astype(float)
    found = []
    for one in groups:
        for corners in one.positions_m[one.triangles].astype(float):
            for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
                along = (b - a) / np.linalg.norm(b - a)
                metres = (points - a) @ along
                aside = np.linalg.norm(points - a - metres[:, None] * along, axis=1)
                inside = (metres > 0.01) & (metres < np.linalg.norm(b - a) - 0.01)
                found += points[inside & (aside < STEP_M)].tolist()
    return found


def area(one):
    corners = one.positions_m[one.triangles].astype(float)
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0) / 2.0


def test_no_vertex_lies_inside_an_edge(floor_and_wall):
    """Else the sky shines through between floor and wall, a sample here and there."""
    assert len(inner_vertices(floor_and_wall)) == 3
    assert inner_vertices(without_t_junctions(floor_and_wall, STEP_M)) == []


def test_surfaces_stay_where_they_were(floor_and_wall):
    """Split triangles cover the same area, on the same side, with the same coordinates."""
    for before, after in zip(
        floor_and_wall, without_t_junctions(floor_and_wall, STEP_M), strict=True
    ):
        assert len(after.triangles) > len(before.triangles)
        assert area(after) == pytest.approx(area(before))
        assert after.uv == pytest.approx(0.5 * after.positions_m[:, [0, 2]])
        assert after.light_px == pytest.approx(after.uv + 3.0)
        assert np.linalg.norm(after.normals, axis=1) == pytest.approx(1.0)


def test_meshes_apart_are_as_they_were(floor_and_wall):
    """Two hundredths of a metre are a gap, not a seam."""
    floor, wall = floor_and_wall
    lifted = replace(wall, positions_m=wall.positions_m + np.float32(0.02))
    for before, after in zip(
        [floor, lifted], without_t_junctions([floor, lifted], STEP_M), strict=True
    ):
        assert np.array_equal(after.triangles, before.triangles)

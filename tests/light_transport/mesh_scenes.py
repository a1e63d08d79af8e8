"""Opened scenes of bare meshes, and meshes that are hard to unwrap."""

import numpy as np
from grey_materials import grey_materials

from vrut_lite.array import Array
from vrut_lite.messages.ground_disc import disc_under
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.scene_content import SceneGeometry


def opened(*meshes, places=None, ground=False):
    """A scene of meshes: positions (V, 3), triangles (F, 3), and normals (V, 3) where they matter.

    `places`: pairs of a mesh's number and a matrix (4, 4); None has each mesh once.
    """
    places = places if places is not None else [(n, np.eye(4)) for n in range(len(meshes))]
    positions, normals, triangles, table = [np.zeros((0, 3))], [np.zeros((0, 3))], [], []
    vertex = triangle = 0
    for points, faces, *given in meshes:
        points, faces = np.asarray(points, float), np.asarray(faces, np.int32).reshape(-1, 3)
        table.append([vertex, len(points), triangle, len(faces), -1, -1, -1, 0])
        vertex, triangle = vertex + len(points), triangle + len(faces)
        positions.append(points)
        normals.append(
            np.asarray(given[0]) if given else np.tile([0.0, 1.0, 0.0], (len(points), 1))
        )
        triangles.append(faces)
    geometry = SceneGeometry(
        positions_m=Array(np.concatenate(positions)),
        normals=Array(np.concatenate(normals)),
        uv=Array(np.zeros((0, 2))),
        colours_rgba=Array(np.zeros((0, 4), np.float32)),
        triangles=Array(np.concatenate([np.zeros((0, 3), np.int32), *triangles])),
        meshes=Array(np.array(table, np.int64).reshape(-1, 8)),
        part_mesh=Array(np.array([mesh for mesh, _ in places], np.int32)),
        world_from_part=Array(np.array([matrix for _, matrix in places], float).reshape(-1, 4, 4)),
    )
    corners = [geometry.world_triangles(part).reshape(-1, 3) for part in range(len(places))]
    points = np.concatenate([np.zeros((1, 3)), *corners])[1:] if places else np.zeros((1, 3))
    points = points if len(points) else np.zeros((1, 3))
    lower, upper = points.min(axis=0), points.max(axis=0)
    scene = SceneOpened(
        path="made", lower_m=tuple(lower), upper_m=tuple(upper), triangles=len(points) // 3,
        geometry=geometry, materials=grey_materials(), camera=None,
        ground=disc_under(lower, upper) if ground else None,
    )  # fmt: skip
    scene.check()
    scene.check_arrays()
    return scene


def box(size=(1.0, 1.0, 1.0)):
    """A closed box of twelve triangles, eight vertices that faces share."""
    points = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * np.array(size)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return points, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def grid(columns, rows, place):
    """A sheet of 2 columns rows triangles; `place` takes shares (N,) across and down to points."""
    s, t = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    points = np.stack(place(s.ravel(), t.ravel()), axis=-1)
    a = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    b, c, d = a + columns + 1, a + columns + 2, a + 1
    return points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def sphere(columns=24, rows=12):
    """A unit sphere with its own normals; its poles are fans with triangles of no area."""

    def place(s, t):
        around, down = 2 * np.pi * s, np.pi * t
        radius = np.sin(down) * (np.abs(t - 0.5) < 0.5)
        return radius * np.sin(around), np.cos(down), radius * np.cos(around)

    points, triangles = grid(columns, rows, place)
    # The seam of the grid ends where it begins, to the last digit.
    points[columns :: columns + 1] = points[:: columns + 1]
    return points, triangles, points / np.linalg.norm(points, axis=1, keepdims=True)


def helix(turns=3.0, steps=60):
    """A winding ramp, whose turns lie above each other."""

    def place(s, t):
        around, radius = 2 * np.pi * turns * s, 1.0 + t
        return radius * np.cos(around), 3.0 * turns * s, radius * np.sin(around)

    return grid(steps, 2, place)


def turned(angle, axis=(1.0, 2.0, 3.0), at=(0.0, 0.0, 0.0)):
    """A matrix (4, 4) that turns about an axis (Rodrigues)."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = np.eye(4)
    matrix[:3, :3] += np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
    matrix[:3, 3] = at
    return matrix

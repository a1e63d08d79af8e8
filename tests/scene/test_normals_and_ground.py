"""Computed normals, and whether a scene has a ground of its own."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from vrut_lite.scene.ground import has_own_ground
from vrut_lite.scene.loading import LoadedScene, load_scene
from vrut_lite.scene.normals import crease_normals


def test_box_has_hard_edges() -> None:
    """A box without normals keeps flat faces: three normals meet at each of eight corners."""
    box = trimesh.creation.box((1, 2, 3))
    source, faces, normals = crease_normals(box.vertices, box.faces)
    assert len(source) == 24
    np.testing.assert_allclose(normals[faces], np.repeat(box.face_normals[:, None], 3, 1))
    np.testing.assert_array_equal(box.vertices[source][faces], box.vertices[box.faces])


def test_ball_is_smooth() -> None:
    """No vertex is split where faces meet at 4 degrees; normals are radial to a twentieth of it."""
    ball = trimesh.creation.icosphere(subdivisions=4)
    source, _, normals = crease_normals(ball.vertices, ball.faces)
    assert len(source) == len(ball.vertices)
    cosine = np.sum(normals * ball.vertices[source], axis=1)
    assert np.degrees(np.arccos(np.clip(cosine.min(), -1, 1))) < 0.2


def test_cylinder_is_smooth_around_and_hard_at_its_rims() -> None:
    """Normals lie level on the mantle and upright on the caps, none between."""
    cylinder = trimesh.creation.cylinder(radius=1.0, height=2.0, sections=32)
    _, faces, normals = crease_normals(cylinder.vertices, cylinder.faces)
    upright = np.abs(normals[:, 2])
    assert np.all((upright < 1e-9) | (upright > 1 - 1e-9))
    mantle = np.abs(cylinder.face_normals[:, 2]) < 0.5
    across = np.ptp(normals[faces[mantle]], axis=1).max(axis=1)
    assert np.all(across > 0.01)


def test_seams_in_texture_coordinates_stay_smooth() -> None:
    """Coinciding vertices get the same normal, although the file lists them twice."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    soup = ball.vertices[ball.faces].reshape(-1, 3)
    source, _, normals = crease_normals(soup, np.arange(len(soup)).reshape(-1, 3))
    order = np.lexsort(soup[source].T)
    same = np.all(np.diff(soup[source][order], axis=0) == 0, axis=1)
    assert same.sum() > 1000
    np.testing.assert_allclose(normals[order][1:][same], normals[order][:-1][same], atol=1e-12)


def test_degenerate_triangles_do_no_harm() -> None:
    """Vertices of triangles without area get normals that point up; neighbours are unaffected."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]], float)
    faces = np.array([[0, 1, 2], [1, 2, 2], [3, 3, 3]])
    _, new_faces, normals = crease_normals(vertices, faces)
    np.testing.assert_allclose(normals[new_faces[0]], [[0, 0, 1]] * 3)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)


def test_blocks_of_triangles_meet(monkeypatch: pytest.MonkeyPatch) -> None:
    """Computing block by block gives the same bits as all at once."""
    random = np.random.default_rng(3)
    faces = np.unique(random.integers(0, 60, (400, 3)), return_inverse=True)[1].reshape(-1, 3)
    vertices = random.integers(-2, 3, (faces.max() + 1, 3)).astype(float)
    whole = crease_normals(vertices, faces)
    monkeypatch.setattr("vrut_lite.scene.normals._BLOCK", 7)
    for one, other in zip(crease_normals(vertices, faces), whole, strict=True):
        np.testing.assert_array_equal(one, other)


def test_box_file_without_normals(tmp_path: Path) -> None:
    """The loader keeps the hard edges."""
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "box.obj")
    mesh = load_scene(tmp_path / "box.obj").meshes[0].mesh
    assert np.allclose(np.abs(mesh.normals).max(axis=1), 1.0)


def ground_scene(folder: Path, *meshes: trimesh.Trimesh) -> LoadedScene:
    """A scene of these meshes."""
    trimesh.Scene(list(meshes)).export(folder / "ground.glb")
    return load_scene(folder / "ground.glb")


def slab(half_m: float, y: float = 0.0) -> trimesh.Trimesh:
    """A thin square slab."""
    box = trimesh.creation.box((2 * half_m, 0.1, 2 * half_m))
    return box.apply_translation([0, y, 0])


def test_wide_ground_is_its_own(tmp_path: Path) -> None:
    """A slab that reaches 600 m needs no disc around it; one that reaches 400 m does."""
    assert has_own_ground(ground_scene(tmp_path, slab(600)))
    assert not has_own_ground(ground_scene(tmp_path, slab(400)))


def test_a_satellite_gets_no_ground(tmp_path: Path) -> None:
    """A ground would hide the planet below a satellite; a hut on a high mountain gets one."""
    assert has_own_ground(ground_scene(tmp_path, slab(5, y=4e5)))
    assert not has_own_ground(ground_scene(tmp_path, slab(5, y=8848.0)))


def test_far_towers_are_no_ground(tmp_path: Path) -> None:
    """Towers at the corners of a wide square do not replace the ground between them."""
    towers = [slab(20).apply_translation([x, 0, z]) for x in (-700, 700) for z in (-700, 700)]
    assert not has_own_ground(ground_scene(tmp_path, *towers))


def test_a_ceiling_is_no_ground(tmp_path: Path) -> None:
    """Surfaces that face down do not count as ground."""
    sheet = trimesh.Trimesh(
        [[-600, 0, -600], [600, 0, -600], [600, 0, 600], [-600, 0, 600]], [[0, 1, 2], [0, 2, 3]]
    )
    assert not has_own_ground(ground_scene(tmp_path, sheet))

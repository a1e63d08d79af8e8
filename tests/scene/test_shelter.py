"""Closed rooms: which points are inside one."""

import numpy as np
import pytest
import trimesh

from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.shelter import Shelter


def write(folder, *meshes, double_sided=False, name="room.glb", alpha_mode=None):
    scene = trimesh.Scene()
    for mesh in meshes:
        material = trimesh.visual.material.PBRMaterial(
            doubleSided=double_sided, alphaMode=alpha_mode
        )
        mesh.visual = trimesh.visual.TextureVisuals(material=material)
        scene.add_geometry(mesh)
    path = folder / name
    scene.export(path)
    return path


def room(size=(4, 3, 5), inwards=True):
    box = trimesh.creation.box(size)
    if inwards:
        box.invert()
    return box


def shelter(path):
    return Shelter(load_scene(path))


def test_a_closed_room_holds_the_points_inside_it(tmp_path):
    """A room's inner faces enclose every point in it, and none outside."""
    closed = shelter(write(tmp_path, room()))
    for point in ([0, 0, 0], [1.9, 1.4, -2.4], [-1.99, 0, 0]):
        assert closed.holds(point)
    for point in ([2.1, 0, 0], [0, 1.6, 0], [0, 0, 30]):
        assert not closed.holds(point)


def test_walls_with_two_sides_close_too(tmp_path):
    """Inner and outer faces are two bodies; the inner one decides."""
    assert shelter(write(tmp_path, room(), room((5, 4, 6), inwards=False))).holds([0, 0, 0])


def test_a_solid_box_is_a_room_only_if_double_sided(tmp_path):
    """From inside, single-sided outer faces are culled: the sky is seen through them."""
    assert not shelter(write(tmp_path, room(inwards=False))).holds([0, 0, 0])
    both = write(tmp_path, room(inwards=False), double_sided=True, name="both.glb")
    assert shelter(both).holds([0, 0, 0])


def test_any_gap_opens_the_room(tmp_path):
    """A missing triangle, or a corner moved by a millimetre, opens the room."""
    gap = room()
    gap.update_faces(np.arange(12) != 5)
    assert not shelter(write(tmp_path, gap)).holds([0, 0, 0])
    walls = room()
    floor = walls.submesh([[0, 1]], append=True)
    rest = walls.submesh([list(range(2, 12))], append=True)
    assert shelter(write(tmp_path, floor.copy(), rest.copy(), name="whole.glb")).holds([0, 0, 0])
    floor.vertices += [1e-3, 0, 0]
    assert not shelter(write(tmp_path, floor, rest, name="moved.glb")).holds([0, 0, 0])


def test_glass_does_not_close_a_room(tmp_path):
    """Transparent faces do not count as walls."""
    assert not shelter(write(tmp_path, room(), alpha_mode="BLEND")).holds([0, 0, 0])


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e6])
def test_a_sphere_of_many_triangles_closes_at_any_scale(tmp_path, scale):
    """The solid angles of a sphere's triangles add up to 4 pi at any scale."""
    ball = trimesh.creation.icosphere(subdivisions=3, radius=scale)
    ball.invert()
    closed = shelter(write(tmp_path, ball))
    assert closed.holds([0.3 * scale, -0.5 * scale, 0.1 * scale])
    assert not closed.holds([1.3 * scale, 0, 0])

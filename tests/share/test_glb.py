"""The scene of a page as a GLB, read back by the program's own loader."""

from pathlib import Path

import numpy as np
import pytest
from share.glb import glb_of
from share.scene_mesh import MeshGroup

from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed

SCENES = Path(__file__).parents[2] / "scenes"


def group(material=0):
    places = np.array([[0, 0, 0], [3, 0, 0], [3, 2, 0], [0, 2, 1]], np.float32)
    normals = np.broadcast_to(np.array([0.0, 0.6, 0.8], np.float32), (4, 3))
    uv = np.array([[0, 0], [2.5, 0], [2.5, 1], [0, 1]], np.float32)
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    return MeshGroup(material, places, normals, uv, None, uv + 10.0, None, triangles)


@pytest.fixture(scope="module")
def read(tmp_path_factory):
    pytest.importorskip("meshopt")
    materials = packed(load_scene(SCENES / "pavilion.gltf")).materials.all()
    textured = next(number for number, one in enumerate(materials) if one.maps)
    path = tmp_path_factory.mktemp("glb") / "scene.glb"
    path.write_bytes(glb_of([group(textured)], materials, (0.1, 0.2, 0.3)))
    return packed(load_scene(path)), materials[textured]


def test_positions_come_back_within_the_quantisation(read):
    """Half of a 65,535th of the bounds: 25 micrometres in three metres."""
    scene = read[0]
    found = np.unique(scene.geometry.world_triangles(0).reshape(-1, 3).round(3), axis=0)
    true = np.unique(group().positions_m, axis=0)
    assert found == pytest.approx(true, abs=1e-4)


def test_texture_coordinates_beyond_one_are_kept(read):
    """Bricks and paving repeat."""
    mesh = read[0].geometry.mesh(0)
    assert mesh.uv.max(axis=0) == pytest.approx([2.5, 1.0], abs=1e-3)
    assert mesh.normals[0] == pytest.approx([0.0, 0.6, 0.8], abs=1e-4)


def test_materials_keep_their_numbers_and_maps(read):
    scene, material = read
    found = next(one for one in scene.materials.all() if one.name == material.name)
    assert found.roughness == pytest.approx(material.roughness)
    assert found.base_colour_rgba == pytest.approx(material.base_colour_rgba)
    assert set(found.maps) >= {"base_colour"} & set(material.maps)

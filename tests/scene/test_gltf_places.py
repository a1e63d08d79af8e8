"""glTF and GLB: containers, the tree of nodes, cameras."""

import base64
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from loaded_scenes import (
    SQUARE_BYTES,
    WriteScene,
    face_normals,
)
from scene_files import glb_bytes, square_document

from vrut_lite.errors import UserError
from vrut_lite.messages.placement import Placement
from vrut_lite.scene.loading import load_scene


def test_same_scene_from_each_container(write_square: WriteScene, tmp_path: Path) -> None:
    """glTF with a file, glTF with a data URI, and GLB hold the same square."""
    embedded = square_document(SQUARE_BYTES)
    embedded["buffers"][0]["uri"] = "data:;base64," + base64.b64encode(SQUARE_BYTES).decode()
    binary = square_document(SQUARE_BYTES)
    del binary["buffers"][0]["uri"]
    (tmp_path / "a.glb").write_bytes(glb_bytes(binary, SQUARE_BYTES))
    paths = [write_square(), write_square(lambda d: d.update(embedded)), tmp_path / "a.glb"]
    for scene in map(load_scene, paths):
        assert scene.triangles == 2
        np.testing.assert_array_equal(scene.lower_m, [0, 0, 0])
        np.testing.assert_array_equal(scene.upper_m, [1, 1, 0])
        assert scene.meshes[0].name == "square"


def test_percent_encoded_name_in_a_folder_below(write_square: WriteScene) -> None:
    """URIs are percent-encoded (RFC 3986); folders below the scene's are its own."""
    path = write_square(lambda d: d["buffers"][0].update(uri="my%20parts/a%231.bin"))
    (path.parent / "my parts").mkdir()
    (path.parent / "square.bin").rename(path.parent / "my parts" / "a#1.bin")
    assert load_scene(path).triangles == 2


def test_link_inside_the_folder(write_square: WriteScene) -> None:
    """A link that stays inside is an ordinary file; so is a link to the scene itself."""
    path = write_square(lambda d: d["buffers"][0].update(uri="link.bin"))
    (path.parent / "link.bin").symlink_to("square.bin")
    (path.parent.parent / "short.gltf").symlink_to(path)
    assert load_scene(path.parent.parent / "short.gltf").triangles == 2


def test_no_graphics_library_is_loaded() -> None:
    """Loading a scene imports neither OpenGL nor Qt nor pyrender."""
    code = (
        "import sys, vrut_lite.scene.loading, vrut_lite.scene.ground;"
        "print({m.split('.')[0] for m in sys.modules}"
        " & {'pyrender', 'OpenGL', 'moderngl', 'PySide6', 'pyglet'})"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "set()"


def test_nested_transforms(write_square: WriteScene) -> None:
    """A child is scaled, then turned, then moved in its parent's axes (glTF 2.0, 3.5.3)."""
    half = np.sqrt(0.5)

    def edit(document: dict[str, Any]) -> None:
        document["nodes"] = [
            {"children": [1], "translation": [10, 0, 0], "rotation": [0, half, 0, half]},
            {"mesh": 0, "translation": [1, 2, 3], "scale": [2, 3, 4]},
        ]

    scene = load_scene(write_square(edit))
    # The child's corner (1, 1, 0): scaled (2, 3, 0), moved (3, 5, 3), turned by 90 degrees
    # about +Y (x to -z, z to x): (3, 5, -3), moved (13, 5, -3).
    np.testing.assert_allclose(scene.upper_m, [13, 5, -1], atol=1e-12)
    np.testing.assert_allclose(scene.lower_m, [13, 2, -3], atol=1e-12)


def test_matrix_is_column_major(write_square: WriteScene) -> None:
    """The translation of a glTF matrix is its last four numbers."""
    matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]
    scene = load_scene(write_square(lambda d: d["nodes"][0].update(matrix=matrix)))
    np.testing.assert_allclose(scene.lower_m, [5, 6, 7])


def test_instances_share_their_mesh(write_square: WriteScene) -> None:
    """Two nodes of one mesh share the object; the triangles of both count."""

    def edit(document: dict[str, Any]) -> None:
        document["nodes"].append({"mesh": 0, "name": "other", "translation": [3, 0, 0]})
        document["scenes"] = [{"nodes": [0, 1]}]

    scene = load_scene(write_square(edit))
    assert [place.name for place in scene.meshes] == ["square", "other"]
    assert scene.meshes[0].mesh is scene.meshes[1].mesh
    assert scene.triangles == 4
    assert scene.upper_m[0] == 4


def test_mirrored_place_keeps_its_front(write_square: WriteScene) -> None:
    """A negative scale mirrors; the winding follows the determinant (glTF 2.0, 3.7.4)."""

    def edit(document: dict[str, Any]) -> None:
        document["nodes"].append({"mesh": 0, "scale": [-1, 1, 1]})
        document["scenes"] = [{"nodes": [0, 1]}]

    scene = load_scene(write_square(edit))
    np.testing.assert_allclose(face_normals(scene), [[0, 0, 1]] * 4)
    np.testing.assert_allclose(scene.lower_m, [-1, 0, 0])
    for place in scene.meshes:
        normals = place.mesh.normals @ np.linalg.inv(place.world_from_model[:3, :3])
        np.testing.assert_allclose(normals, [[0, 0, 1]] * 4)


def test_scenes_of_a_file(write_square: WriteScene) -> None:
    """Only the default scene shows; without scenes, the whole forest does."""

    def two(document: dict[str, Any]) -> None:
        document["nodes"].append({"mesh": 0, "translation": [9, 0, 0]})
        document["scenes"] = [{"nodes": [0]}, {"nodes": [1]}]
        document["scene"] = 1

    def none(document: dict[str, Any]) -> None:
        two(document)
        del document["scenes"], document["scene"]

    assert load_scene(write_square(two)).lower_m[0] == 9
    assert load_scene(write_square(none)).triangles == 4


def test_camera_of_a_nested_node(write_square: WriteScene) -> None:
    """The camera's pose is rigid, in world axes, whatever the scale above it."""

    def edit(document: dict[str, Any]) -> None:
        lens = {"yfov": 0.7, "znear": 0.1}
        document["cameras"] = [
            {"type": "orthographic", "orthographic": {}},
            {"type": "perspective", "perspective": lens},
        ]
        document["nodes"] += [
            {"children": [2, 3], "scale": [2, 2, 2], "translation": [0, 1, 0]},
            {"camera": 0},
            {"camera": 1, "translation": [1, 0, 4], "children": [4]},
            {"mesh": 0, "translation": [0, 0, -7]},
        ]
        document["scenes"] = [{"nodes": [0, 1]}]

    scene = load_scene(write_square(edit))
    assert scene.camera is not None
    assert scene.camera.vertical_field_of_view_rad == 0.7
    expected = np.eye(4)
    expected[:3, 3] = [2, 1, 8]
    np.testing.assert_allclose(scene.camera.world_from_camera, expected, atol=1e-12)
    # Meshes below a camera node load too.
    np.testing.assert_allclose(scene.meshes[1].world_from_model[:3, 3], [2, 1, -6])


def test_no_camera(write_square: WriteScene) -> None:
    """A scene without a camera says so."""
    assert load_scene(write_square()).camera is None


def test_a_camera_is_chosen_by_name_or_number(write_square: WriteScene) -> None:
    """The first camera is the default; another is named, and a wrong name lists those there are."""

    def edit(document: dict[str, Any]) -> None:
        document["cameras"] = [
            {"type": "perspective", "perspective": {"yfov": angle, "znear": 0.1}}
            for angle in (0.5, 0.6)
        ]
        document["cameras"].append({"type": "orthographic", "orthographic": {}})
        document["nodes"] += [
            {"camera": 0, "name": "gate"},
            {"camera": 1, "name": "tower", "translation": [0, 9, 0]},
            {"camera": 2},
        ]
        document["scenes"][0]["nodes"] = [0, 1, 2, 3]

    path = write_square(edit)
    scene = load_scene(path)
    assert [camera.name for camera in scene.cameras] == ["gate", "tower"]
    assert scene.notices == ("orthographic camera: not offered",)
    for name in ("tower", "2"):
        camera = load_scene(path, camera=name).camera
        assert camera is not None
        assert camera.vertical_field_of_view_rad == 0.6
    with pytest.raises(UserError, match=r"no camera 'roof': there are 1 \(gate\), 2 \(tower\)"):
        load_scene(path, camera="roof")


def test_a_camera_moves_with_its_scene(write_square: WriteScene) -> None:
    """A scene in centimetres that stands elsewhere takes its camera with it, unscaled."""

    def edit(document: dict[str, Any]) -> None:
        document["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}]
        document["nodes"].append({"camera": 0, "translation": [0, 0, 100]})
        document["scenes"][0]["nodes"] = [0, 1]

    place = Placement(metres_per_unit=0.01, position_m=(3.0, 0.0, 0.0), heading_deg=90.0)
    camera = load_scene(write_square(edit), placement=place).camera
    assert camera is not None
    pose = camera.world_from_camera
    np.testing.assert_allclose(pose[:3, 3], [2.0, 0.0, 0.0], atol=1e-12)
    # It looked north (-Z); now it looks east.
    np.testing.assert_allclose(-pose[:3, 2], [1.0, 0.0, 0.0], atol=1e-12)

"""glTF: vertices, indices and their encodings."""

from typing import Any

import numpy as np
import pytest
from loaded_scenes import WriteScene, add_array, face_normals, give
from scene_files import SQUARE

from vrut_lite.scene.loading import load_scene


def test_authored_normals_stay(write_square: WriteScene) -> None:
    """Normals in the file are normalised and kept, even if they differ from the triangle's."""
    authored = np.array([[0, 0, 2], [0, 3, 4], [1, 0, 0], [0, 0, 1]], "<f4")

    def edit(document: dict[str, Any]) -> None:
        give(document, NORMAL=add_array(document, authored))

    mesh = load_scene(write_square(edit)).meshes[0].mesh
    expected = authored / np.linalg.norm(authored, axis=1, keepdims=True)
    np.testing.assert_allclose(mesh.normals, expected, rtol=1e-6)


@pytest.mark.parametrize("bad", [[0, 0, 0], [np.nan, 0, 1]])
def test_bad_normals_are_replaced(write_square: WriteScene, bad: list[float]) -> None:
    """Normals are computed if one has no direction, which would give black or NaN pixels."""
    authored = np.array([[0, 1, 0], bad, [0, 1, 0], [0, 1, 0]], "<f4")

    def edit(document: dict[str, Any]) -> None:
        give(document, NORMAL=add_array(document, authored))

    mesh = load_scene(write_square(edit)).meshes[0].mesh
    np.testing.assert_allclose(mesh.normals, [[0, 0, 1]] * len(mesh.vertices))


def test_quantised_vertices(write_square: WriteScene) -> None:
    """KHR_mesh_quantization: 16-bit positions as they are, 8-bit normals over 127."""
    positions = np.concatenate([SQUARE * 1000, np.zeros((4, 1))], axis=1).astype("<i2")
    normals = np.array([[0, 0, 127, 0]] * 4, "<i1")

    def edit(document: dict[str, Any]) -> None:
        document["extensionsRequired"] = ["KHR_mesh_quantization"]
        place = add_array(document, positions, type="VEC3")
        document["bufferViews"][-1]["byteStride"] = 8
        normal = add_array(document, normals, type="VEC3", normalized=True)
        document["bufferViews"][-1]["byteStride"] = 4
        give(document, POSITION=place, NORMAL=normal)
        document["nodes"][0]["scale"] = [0.001] * 3

    scene = load_scene(write_square(edit))
    np.testing.assert_allclose(scene.upper_m, [1, 1, 0])
    np.testing.assert_allclose(scene.meshes[0].mesh.normals, [[0, 0, 1]] * 4)


def test_normalised_texture_coordinates(write_square: WriteScene) -> None:
    """Unsigned shorts from 0 to 65535 are 0 to 1 (glTF 2.0, 3.6.2.2); v turns upwards."""
    uv = np.array([[0, 0], [65535, 0], [65535, 65535], [0, 65535]], "<u2")

    def edit(document: dict[str, Any]) -> None:
        give(document, TEXCOORD_0=add_array(document, uv, normalized=True))

    mesh = load_scene(write_square(edit)).meshes[0].mesh
    np.testing.assert_allclose(mesh.uv, [[0, 1], [1, 1], [1, 0], [0, 0]])


def test_sparse_positions(write_square: WriteScene) -> None:
    """A sparse accessor replaces some elements (glTF 2.0, 3.6.2.3)."""

    def edit(document: dict[str, Any]) -> None:
        add_array(document, np.array([2], "<u2"))
        add_array(document, np.array([[5, 6, 0]], "<f4"))
        document["accessors"][0]["sparse"] = {
            "count": 1,
            "indices": {"bufferView": 2, "componentType": 5123},
            "values": {"bufferView": 3},
        }

    np.testing.assert_array_equal(load_scene(write_square(edit)).upper_m, [5, 6, 0])


@pytest.mark.parametrize(("mode", "order"), [(5, [0, 1, 3, 2]), (6, [0, 1, 2, 3])])
def test_strips_and_fans(write_square: WriteScene, mode: int, order: list[int]) -> None:
    """Strips turn every second triangle; both make the same square, facing +Z."""

    def edit(document: dict[str, Any]) -> None:
        indices = add_array(document, np.array(order, "<u2"))
        document["meshes"][0]["primitives"][0].update(mode=mode, indices=indices)

    scene = load_scene(write_square(edit))
    np.testing.assert_allclose(face_normals(scene), [[0, 0, 1]] * 2)
    a, b, c = np.moveaxis(scene.meshes[0].world_triangles(), 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert area == pytest.approx(1.0)


def test_triangles_without_indices(write_square: WriteScene) -> None:
    """Without indices every three vertices are a triangle; a remainder is ignored."""

    def edit(document: dict[str, Any]) -> None:
        del document["meshes"][0]["primitives"][0]["indices"]

    assert load_scene(write_square(edit)).triangles == 1


def test_lines_and_points_are_passed_over(write_square: WriteScene) -> None:
    """Lines and points are ignored; triangles beside them load."""

    def edit(document: dict[str, Any]) -> None:
        document["meshes"][0]["primitives"] += [
            {"attributes": {"POSITION": 0}, "mode": 1},
            {"attributes": {"POSITION": 0}, "mode": 0},
        ]

    assert len(load_scene(write_square(edit)).meshes) == 1


def test_vertex_colours(write_square: WriteScene) -> None:
    """COLOR_0 is kept, linear, with alpha added where there is none."""
    colours = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [51, 51, 51]], "<u1")
    padded = np.concatenate([colours, np.zeros((4, 1), "<u1")], axis=1)

    def edit(document: dict[str, Any]) -> None:
        number = add_array(document, padded, type="VEC3", normalized=True)
        document["bufferViews"][-1]["byteStride"] = 4
        give(document, COLOR_0=number)

    colour = load_scene(write_square(edit)).meshes[0].mesh.colours
    np.testing.assert_allclose(colour[:, :3], colours / 255.0, rtol=1e-6)
    np.testing.assert_allclose(colour[:, 3], 1.0)

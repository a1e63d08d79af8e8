"""What a scene file says arrives: places, materials, pictures, normals, a camera."""

import base64
import contextlib
import subprocess
import sys
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image
from scene_files import SQUARE, TRIANGLES, add_texture, glb_bytes, png_bytes, square_document

from vrut_lite.errors import UserError
from vrut_lite.scene.ground import has_own_ground
from vrut_lite.scene.loading import LoadedScene, load_scene
from vrut_lite.scene.materials import SurfaceMaterial
from vrut_lite.scene.normals import crease_normals

WriteScene = Callable[..., Path]
SQUARE_BYTES = SQUARE.tobytes() + TRIANGLES.tobytes()
MODELS = Path(__file__).resolve().parents[1] / "data" / "models"


def material_of(scene: LoadedScene) -> SurfaceMaterial:
    """The first mesh's material."""
    material = scene.meshes[0].mesh.visual.material
    assert isinstance(material, SurfaceMaterial)
    return material


def face_normals(scene: LoadedScene) -> np.ndarray:
    """Unit normals of all triangles in world axes, from their winding."""
    a, b, c = np.moveaxis(np.concatenate([p.world_triangles() for p in scene.meshes]), 1, 0)
    normal = np.cross(b - a, c - a)
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def add_array(document: dict[str, Any], values: np.ndarray, **accessor: Any) -> int:
    """A new accessor with its own buffer, in a data URI; its number."""
    kinds = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}
    names = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
    data = values.tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    document["buffers"].append({"uri": uri, "byteLength": len(data)})
    document["bufferViews"].append(
        {"buffer": len(document["buffers"]) - 1, "byteLength": len(data)}
    )
    document["accessors"].append(
        {
            "bufferView": len(document["bufferViews"]) - 1,
            "componentType": kinds[values.dtype.char],
            "count": len(values),
            "type": names[values.shape[1] if values.ndim == 2 else 1],
            **accessor,
        }
    )
    return len(document["accessors"]) - 1


def give(document: dict[str, Any], **attributes: int) -> None:
    """Add attributes to the square."""
    document["meshes"][0]["primitives"][0]["attributes"].update(attributes)


# --- containers -----------------------------------------------------------------------


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
    """Loading works where there is no OpenGL and no Qt: neither they nor pyrender come in."""
    code = (
        "import sys, vrut_lite.scene.loading, vrut_lite.scene.ground;"
        "print({m.split('.')[0] for m in sys.modules}"
        " & {'pyrender', 'OpenGL', 'moderngl', 'PySide6', 'pyglet'})"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "set()"


# --- places ---------------------------------------------------------------------------


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
    """Two nodes of one mesh are one object in two places, and both count."""

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
        normals = place.mesh.vertex_normals @ np.linalg.inv(place.world_from_model[:3, :3])
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
    # What hangs below a camera shows as well.
    np.testing.assert_allclose(scene.meshes[1].world_from_model[:3, 3], [2, 1, -6])


def test_no_camera(write_square: WriteScene) -> None:
    """A scene without a camera says so."""
    assert load_scene(write_square()).camera is None


# --- arrays ---------------------------------------------------------------------------


def test_authored_normals_stay(write_square: WriteScene) -> None:
    """Normals in the file are kept, made unit length, also where they are not the triangle's."""
    authored = np.array([[0, 0, 2], [0, 3, 4], [1, 0, 0], [0, 0, 1]], "<f4")

    def edit(document: dict[str, Any]) -> None:
        give(document, NORMAL=add_array(document, authored))

    mesh = load_scene(write_square(edit)).meshes[0].mesh
    expected = authored / np.linalg.norm(authored, axis=1, keepdims=True)
    np.testing.assert_allclose(mesh.vertex_normals, expected, rtol=1e-6)


@pytest.mark.parametrize("bad", [[0, 0, 0], [np.nan, 0, 1]])
def test_bad_normals_are_made_anew(write_square: WriteScene, bad: list[float]) -> None:
    """A normal without direction would light nothing, or spoil the picture with NaN."""
    authored = np.array([[0, 1, 0], bad, [0, 1, 0], [0, 1, 0]], "<f4")

    def edit(document: dict[str, Any]) -> None:
        give(document, NORMAL=add_array(document, authored))

    mesh = load_scene(write_square(edit)).meshes[0].mesh
    np.testing.assert_allclose(mesh.vertex_normals, [[0, 0, 1]] * len(mesh.vertices))


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
    np.testing.assert_allclose(scene.meshes[0].mesh.vertex_normals, [[0, 0, 1]] * 4)


def test_normalised_texture_coordinates(write_square: WriteScene) -> None:
    """Unsigned shorts from 0 to 65535 are 0 to 1 (glTF 2.0, 3.6.2.2); v turns upwards."""
    uv = np.array([[0, 0], [65535, 0], [65535, 65535], [0, 65535]], "<u2")

    def edit(document: dict[str, Any]) -> None:
        give(document, TEXCOORD_0=add_array(document, uv, normalized=True))

    visual = load_scene(write_square(edit)).meshes[0].mesh.visual
    np.testing.assert_allclose(visual.uv, [[0, 1], [1, 1], [1, 0], [0, 0]])


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
    assert scene.meshes[0].mesh.area == pytest.approx(1.0)


def test_triangles_without_indices(write_square: WriteScene) -> None:
    """Without indices each three vertices are a triangle; a rest of one is left over."""

    def edit(document: dict[str, Any]) -> None:
        del document["meshes"][0]["primitives"][0]["indices"]

    assert load_scene(write_square(edit)).triangles == 1


def test_lines_and_points_are_passed_over(write_square: WriteScene) -> None:
    """Helpers made of lines do not hinder the triangles beside them."""

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

    colour = load_scene(write_square(edit)).meshes[0].mesh.vertex_attributes["color"]
    np.testing.assert_allclose(colour[:, :3], colours / 255.0, rtol=1e-6)
    np.testing.assert_allclose(colour[:, 3], 1.0)


# --- materials ------------------------------------------------------------------------


def test_material_factors_are_exact(write_square: WriteScene) -> None:
    """Factors are floating point and linear: 8 bits would make 0.0196 of an albedo of 0.02."""

    def edit(document: dict[str, Any]) -> None:
        document["materials"][0] = {
            "name": "soot",
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.02, 0.021, 0.022, 0.5],
                "metallicFactor": 0.1,
                "roughnessFactor": 0.7,
            },
            "emissiveFactor": [0.0, 0.5, 1.0],
            "alphaMode": "BLEND",
            "doubleSided": True,
        }

    material = material_of(load_scene(write_square(edit)))
    np.testing.assert_array_equal(material.baseColorFactor, [0.02, 0.021, 0.022, 0.5])
    assert (material.metallicFactor, material.roughnessFactor) == (0.1, 0.7)
    np.testing.assert_array_equal(material.emissiveFactor, [0.0, 0.5, 1.0])
    assert (material.name, material.alphaMode, material.doubleSided) == ("soot", "BLEND", True)


def test_material_defaults(write_square: WriteScene) -> None:
    """What a material leaves out is glTF's default: white, metallic 1, roughness 1, opaque."""
    material = material_of(load_scene(write_square()))
    np.testing.assert_array_equal(material.baseColorFactor, [1, 1, 1, 1])
    assert (material.metallicFactor, material.roughnessFactor) == (1.0, 1.0)
    assert (material.alphaMode, material.alphaCutoff) == ("OPAQUE", 0.5)


def test_mesh_without_material(write_square: WriteScene) -> None:
    """Bare geometry is matt mid-grey, not the dark metal of glTF's default material."""

    def edit(document: dict[str, Any]) -> None:
        del document["meshes"][0]["primitives"][0]["material"]

    material = material_of(load_scene(write_square(edit)))
    np.testing.assert_array_equal(material.baseColorFactor, [0.5, 0.5, 0.5, 1.0])
    assert (material.metallicFactor, material.roughnessFactor) == (0.0, 1.0)


def test_all_textures_of_a_material(write_square: WriteScene) -> None:
    """Each of the five textures arrives; an image that two share is decoded once."""

    def edit(document: dict[str, Any]) -> None:
        add_texture(document, {"uri": "a.png"})
        document["images"].append({"uri": "b.png"})
        document["textures"].append({"source": 1})
        document["materials"][0].update(
            normalTexture={"index": 1},
            occlusionTexture={"index": 0},
            emissiveTexture={"index": 1},
        )
        pbr = document["materials"][0]["pbrMetallicRoughness"]
        pbr["metallicRoughnessTexture"] = {"index": 0}

    path = write_square(edit)
    (path.parent / "a.png").write_bytes(png_bytes((8, 4)))
    (path.parent / "b.png").write_bytes(png_bytes((2, 2), "RGBA"))
    material = material_of(load_scene(path))
    assert material.baseColorTexture.size == (8, 4)
    assert material.baseColorTexture is material.occlusionTexture
    assert material.baseColorTexture is material.metallicRoughnessTexture
    assert material.normalTexture is material.emissiveTexture
    assert (material.baseColorTexture.mode, material.normalTexture.mode) == ("RGB", "RGBA")


@pytest.mark.parametrize(("mode", "value"), [("L", 128), ("P", 128), ("1", 255), ("I;16", 32896)])
def test_pictures_of_every_depth(write_square: WriteScene, mode: str, value: int) -> None:
    """Greys, palettes and 16 bits become RGB of the same brightness: 32896 / 257 = 128."""
    path = write_square(lambda d: add_texture(d, {"uri": "a.png"}))
    if mode == "P":
        image = Image.new("RGB", (3, 3), (value,) * 3).quantize()
    elif mode == "I;16":
        image = Image.fromarray(np.full((3, 3), value, np.uint16))
    else:
        image = Image.new(mode, (3, 3), value)
    image.save(path.parent / "a.png")
    texture = material_of(load_scene(path)).baseColorTexture
    assert texture.mode == "RGB"
    assert texture.getpixel((1, 1)) == (min(value, 128 if mode == "I;16" else value),) * 3


def test_webp_instead_of_png(write_square: WriteScene) -> None:
    """EXT_texture_webp names the image to take instead."""

    def edit(document: dict[str, Any]) -> None:
        add_texture(document, {"uri": "a.png"})
        document["images"].append({"uri": "a.webp"})
        document["textures"][0]["extensions"] = {"EXT_texture_webp": {"source": 1}}
        document["extensionsRequired"] = ["EXT_texture_webp"]

    path = write_square(edit)
    (path.parent / "a.png").write_bytes(png_bytes((4, 4)))
    Image.new("RGB", (6, 6)).save(path.parent / "a.webp")
    assert material_of(load_scene(path)).baseColorTexture.size == (6, 6)


def test_texture_transform(write_square: WriteScene) -> None:
    """KHR_texture_transform: scaled, then turned, then moved; its own set of coordinates."""
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], "<f4")

    def edit(document: dict[str, Any]) -> None:
        add_texture(document, {"uri": "a.png"})
        give(document, TEXCOORD_1=add_array(document, uv))
        document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {
            "KHR_texture_transform": {
                "offset": [0.1, 0.2],
                "rotation": np.pi / 2,
                "scale": [2, 3],
                "texCoord": 1,
            }
        }

    path = write_square(edit)
    (path.parent / "a.png").write_bytes(png_bytes())
    got = load_scene(path).meshes[0].mesh.visual.uv
    # The extension's matrix for a right angle: u' = s_v v + 0.1, v' = -s_u u + 0.2.
    expected = np.stack([3 * uv[:, 1] + 0.1, -2 * uv[:, 0] + 0.2], axis=1)
    np.testing.assert_allclose(got, np.stack([expected[:, 0], 1 - expected[:, 1]], 1), atol=1e-6)


# --- OBJ ------------------------------------------------------------------------------


def test_obj_material(write_obj: WriteScene) -> None:
    """Kd is the base colour, d the alpha, Ns the roughness: r^4 = 2 / (Ns + 2), 30 gives 0.5."""
    mtl = "newmtl paint\nKa 1 1 1\nKd 0.1 0.2 0.3\nKs 1 1 1\nNs 30\nd 0.25\nillum 2\n"
    material = material_of(load_scene(write_obj(mtl)))
    np.testing.assert_allclose(material.baseColorFactor, [0.1, 0.2, 0.3, 0.25])
    assert material.roughnessFactor == pytest.approx(0.5)
    assert (material.metallicFactor, material.alphaMode) == (0.0, "BLEND")


def test_obj_transparency_and_pbr_words(write_obj: WriteScene) -> None:
    """Tr is the opposite of d; Pm, Pr and Ke are the physically based extension's."""
    mtl = "newmtl paint\nTr 0.4\nPm 1\nPr 0.3\nNs 500\nKe 2 1 0\n"
    material = material_of(load_scene(write_obj(mtl)))
    assert material.baseColorFactor[3] == pytest.approx(0.6)
    assert (material.metallicFactor, material.roughnessFactor) == (1.0, 0.3)
    np.testing.assert_allclose(material.emissiveFactor, [2, 1, 0])


@pytest.mark.parametrize(
    "name", ["wall.png", "a wall.png", "-s 2 2 1 wall.png", "-clamp on -bm 0.5 wall.png"]
)
def test_obj_texture(write_obj: WriteScene, name: str) -> None:
    """map_Kd is the base colour's picture, whatever options stand before its name."""
    path = write_obj(f"newmtl paint\nKd 1 1 1\nmap_Kd {name}\n")
    file = "a wall.png" if name.startswith("a ") else "wall.png"
    (path.parent / file).write_bytes(png_bytes((16, 8)))
    scene = load_scene(path)
    assert material_of(scene).baseColorTexture.size == (16, 8)
    np.testing.assert_allclose(scene.meshes[0].mesh.visual.uv, [[0, 0], [1, 0], [1, 1], [0, 1]])


def test_obj_cut_out(write_obj: WriteScene) -> None:
    """A picture with an alpha channel cuts out: leaves, fences."""
    path = write_obj("newmtl paint\nmap_Kd leaf.png\n")
    (path.parent / "leaf.png").write_bytes(png_bytes((4, 4), "RGBA"))
    assert material_of(load_scene(path)).alphaMode == "MASK"


def test_obj_without_materials(write_obj: WriteScene) -> None:
    """Bare OBJ geometry is matt mid-grey."""
    material = material_of(load_scene(write_obj()))
    np.testing.assert_array_equal(material.baseColorFactor, [0.5, 0.5, 0.5, 1.0])


def test_obj_meshes_keep_their_own_material(write_obj: WriteScene) -> None:
    """Faces go to the material named last before them."""
    mtl = "newmtl paint\nKd 1 0 0\nnewmtl other\nKd 0 1 0\n"
    faces = "f 1/1 2/2 3/3\nusemtl other\nf 1/1 3/3 4/4"
    scene = load_scene(write_obj(mtl, faces))
    colours = {p.mesh.visual.material.name: p.mesh.visual.material for p in scene.meshes}
    np.testing.assert_array_equal(colours["paint"].baseColorFactor, [1, 0, 0, 1])
    np.testing.assert_array_equal(colours["other"].baseColorFactor, [0, 1, 0, 1])


@pytest.mark.parametrize(
    ("faces", "triangles"),
    [
        ("f 1 2 3 4", 2),
        ("f 1/1 2/2 3/3 4/4", 2),
        ("f 1/1/1 2/2/1 3/3/1 4/4/1", 2),
        ("f 1//1 2//1 3//1 4//1", 2),
        ("f 1 2 3\nf 1 3 4", 2),
        ("f -4 -3 -2 -1", 2),
        ("f -4/-4 -3/-3 -2/-2 -1/-1", 2),
        ("f\t1  2\t3 4 ", 2),
        ("f 1 2 3\nf 1 2 3 4", 3),
        ("v 0.5 1.5 0\nf 1 2 3 5 4", 3),
    ],
)
def test_obj_faces(write_obj: WriteScene, faces: str, triangles: int) -> None:
    """Polygons are cut into fans; every way to write a corner is read."""
    scene = load_scene(write_obj(faces=f"vn 0 0 1\n{faces}"))
    assert scene.triangles == triangles
    np.testing.assert_allclose(scene.meshes[0].mesh.vertex_normals[:, 2], 1.0)


def test_obj_counts_back_from_the_present_line(write_obj: WriteScene) -> None:
    """-1 is the last vertex so far, not the last of the file."""
    faces = "f -4 -3 -2 -1\nv 50 50 50\nv 60 60 60"
    np.testing.assert_array_equal(load_scene(write_obj(faces=faces)).upper_m, [1, 1, 0])


def test_obj_normals_stay(write_obj: WriteScene) -> None:
    """vn is kept, also where it is not the triangle's normal."""
    faces = "vn 0 0.6 0.8\nf 1//1 2//1 3//1"
    mesh = load_scene(write_obj(faces=faces)).meshes[0].mesh
    np.testing.assert_allclose(mesh.vertex_normals, [[0, 0.6, 0.8]] * 3)


def test_obj_of_trimesh(tmp_path: Path) -> None:
    """A file of another writer: trimesh's own export of a textured box."""
    box = trimesh.creation.box((1, 2, 3))
    image = Image.new("RGB", (5, 5), (255, 0, 0))
    material = trimesh.visual.material.SimpleMaterial(image=image, glossiness=1.0)
    uv = box.vertices[:, :2] - box.vertices[:, :2].min(axis=0)
    box.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    box.export(tmp_path / "box.obj")
    scene = load_scene(tmp_path / "box.obj")
    assert scene.triangles == 12
    assert material_of(scene).baseColorTexture.size == (5, 5)
    np.testing.assert_allclose(scene.upper_m, [0.5, 1.0, 1.5])


# --- normals --------------------------------------------------------------------------


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
    """Vertices that coincide shade alike, though the file lists them twice."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    soup = ball.vertices[ball.faces].reshape(-1, 3)
    source, _, normals = crease_normals(soup, np.arange(len(soup)).reshape(-1, 3))
    order = np.lexsort(soup[source].T)
    same = np.all(np.diff(soup[source][order], axis=0) == 0, axis=1)
    assert same.sum() > 1000
    np.testing.assert_allclose(normals[order][1:][same], normals[order][:-1][same], atol=1e-12)


def test_degenerate_triangles_do_no_harm() -> None:
    """A triangle without area has no normal; its vertices point up and no neighbour suffers."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]], float)
    faces = np.array([[0, 1, 2], [1, 2, 2], [3, 3, 3]])
    _, new_faces, normals = crease_normals(vertices, faces)
    np.testing.assert_allclose(normals[new_faces[0]], [[0, 0, 1]] * 3)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)


def test_box_file_without_normals(tmp_path: Path) -> None:
    """The hard edges arrive through the loader."""
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "box.obj")
    mesh = load_scene(tmp_path / "box.obj").meshes[0].mesh
    assert np.allclose(np.abs(mesh.vertex_normals).max(axis=1), 1.0)


# --- ground ---------------------------------------------------------------------------


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


def test_far_things_are_no_ground(tmp_path: Path) -> None:
    """Towers at the corners of a wide square leave the ground between them open."""
    towers = [slab(20).apply_translation([x, 0, z]) for x in (-700, 700) for z in (-700, 700)]
    assert not has_own_ground(ground_scene(tmp_path, *towers))


def test_a_ceiling_is_no_ground(tmp_path: Path) -> None:
    """What faces down does not count."""
    sheet = trimesh.Trimesh(
        [[-600, 0, -600], [600, 0, -600], [600, 0, 600], [-600, 0, 600]], [[0, 1, 2], [0, 2, 3]]
    )
    assert not has_own_ground(ground_scene(tmp_path, sheet))


def test_base_height(tmp_path: Path) -> None:
    """The base is the lowest point."""
    assert ground_scene(tmp_path, slab(1, y=3.0)).base_height_m == pytest.approx(2.95)


# --- files of others ------------------------------------------------------------------


def test_foreign_model() -> None:
    """A model that others made: interleaved vertices, a JPEG inside (counts by its header)."""
    scene = load_scene(MODELS / "pmndrs.glb")
    assert scene.triangles == 4656 // 3
    np.testing.assert_allclose(scene.upper_m, [3.499999761581421] * 2 + [1.0000207424163818])
    material = material_of(scene)
    assert material.baseColorTexture.size == (2048, 2048)
    assert (material.metallicFactor, material.roughnessFactor) == (0.0, 0.5)
    mesh = scene.meshes[0].mesh
    assert mesh.visual.uv.shape == (1074, 2)
    assert 0.0 <= mesh.visual.uv.min() <= mesh.visual.uv.max() <= 1.0


def test_foreign_model_packed_by_draco() -> None:
    """The same model as it was published, packed by Draco, has the unpacked one's triangles.

    Draco keeps 14 bits of a position (glTF-Transform's default), so corners agree to 1e-3.
    """
    packed, plain = load_scene(MODELS / "pmndrs_draco.glb"), load_scene(MODELS / "pmndrs.glb")
    assert packed.triangles == plain.triangles
    np.testing.assert_allclose(packed.upper_m, plain.upper_m, atol=1e-3)
    assert material_of(packed).baseColorTexture.size == (2048, 2048)
    ours, theirs = packed.meshes[0].mesh, plain.meshes[0].mesh
    np.testing.assert_allclose(ours.area, theirs.area, rtol=1e-3)
    np.testing.assert_allclose(ours.visual.uv.max(axis=0), theirs.visual.uv.max(axis=0), atol=1e-3)


@pytest.mark.parametrize("seed", range(20))
def test_mangled_draco_is_refused_or_read(tmp_path: Path, seed: int) -> None:
    """Packed bytes with flipped bits either unpack to a scene or give one sentence."""
    data = bytearray((MODELS / "pmndrs_draco.glb").read_bytes())
    rng = np.random.default_rng(seed)
    for at in rng.integers(len(data) // 2, len(data), 12):
        data[at] ^= int(rng.integers(1, 256))
    path = tmp_path / "mangled.glb"
    path.write_bytes(data)
    with contextlib.suppress(UserError):
        load_scene(path)


def test_glb_of_trimesh(tmp_path: Path) -> None:
    """trimesh's own export of a textured, placed ball loads as trimesh has it."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    uv = np.random.default_rng(1).random((len(ball.vertices), 2))
    picture = BytesIO(png_bytes((4, 2)))
    material = trimesh.visual.material.PBRMaterial(
        baseColorTexture=Image.open(picture), roughnessFactor=0.25
    )
    ball.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    scene = trimesh.Scene()
    scene.add_geometry(ball, transform=trimesh.transformations.translation_matrix([1, 2, 3]))
    scene.export(tmp_path / "ball.glb")
    loaded = load_scene(tmp_path / "ball.glb")
    np.testing.assert_allclose(loaded.meshes[0].mesh.visual.uv, uv, atol=1e-6)
    np.testing.assert_allclose((loaded.lower_m + loaded.upper_m) / 2, [1, 2, 3], atol=1e-6)
    assert material_of(loaded).baseColorTexture.size == (4, 2)
    assert material_of(loaded).roughnessFactor == 0.25

"""glTF: materials and textures."""

from typing import Any

import numpy as np
import pytest
from loaded_scenes import WriteScene, add_array, give, material_of
from PIL import Image
from scene_files import add_texture, png_bytes

from vrut_lite.scene.loading import load_scene


def test_material_factors_are_exact(write_square: WriteScene) -> None:
    """Factors stay floating point and linear: 8 bits would turn an albedo of 0.02 into 0.0196."""

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
    """Missing properties have glTF's defaults: white, metallic 1, roughness 1, opaque."""
    material = material_of(load_scene(write_square()))
    np.testing.assert_array_equal(material.baseColorFactor, [1, 1, 1, 1])
    assert (material.metallicFactor, material.roughnessFactor) == (1.0, 1.0)
    assert (material.alphaMode, material.alphaCutoff) == ("OPAQUE", 0.5)


def test_mesh_without_material(write_square: WriteScene) -> None:
    """A mesh without material or colours is matt mid-grey, not the dark metal of glTF's default."""

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


def test_a_tall_picture_of_16_bits(write_square: WriteScene) -> None:
    """All 65536 greys, in more rows than are scaled at once, are v / 257 rounded."""
    path = write_square(lambda d: add_texture(d, {"uri": "a.png"}))
    greys = np.arange(2**16, dtype=np.uint16).reshape(1024, 64)
    Image.fromarray(greys).save(path.parent / "a.png")
    texture = np.asarray(material_of(load_scene(path)).baseColorTexture)
    np.testing.assert_array_equal(texture[..., 1], np.round(greys / 257.0))


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
    got = load_scene(path).meshes[0].mesh.uv
    # The extension's matrix for a right angle: u' = s_v v + 0.1, v' = -s_u u + 0.2.
    expected = np.stack([3 * uv[:, 1] + 0.1, -2 * uv[:, 0] + 0.2], axis=1)
    np.testing.assert_allclose(got, np.stack([expected[:, 0], 1 - expected[:, 1]], 1), atol=1e-6)

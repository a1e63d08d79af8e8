"""Packed glTF: buffers of meshoptimizer, pictures of Basis Universal, every integer type."""

import base64
import sys
from typing import Any

import numpy as np
import pytest
from loaded_scenes import WriteScene, add_array, give, material_of
from scene_files import SQUARE, TRIANGLES, add_texture, png_bytes

from vrut_lite.errors import UserError
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.loading import load_scene

meshopt = pytest.importorskip("meshopt", reason="the package meshopt is not installed")
pytest.importorskip("opengl_basisu", reason="the package opengl_basisu is not installed")

# 8 x 8 pixels in four fields, red and green above blue and a grey of alpha 64, by basis_universal's
# encoder.
KTX2 = {
    "etc1s": (
        "q0tUWCAyMLsNChoKAAAAAAEAAAAIAAAACAAAAAAAAAAAAAAAAQAAAAEAAAABAAAAaAAAADwAAACkAAAAJAAA"
        "AMgAAAAAAAAAkgAAAAAAAABaAQAAAAAAAAQAAAAAAAAAAAAAAAAAAAA8AAAAAAAAAAIAOACjAQIAAwMAAAgI"
        "AAAAAAAAAAA/AAAAAAAAAAAA/////0AAPw8AAAAAAAAAAP////8fAAAAS1RYd3JpdGVyAEJhc2lzIFVuaXZl"
        "cnNhbCAyLjEwAAAGAAIAMgAAAAkAAAAvAAAAAAAAAAAAAAAAAAAAAgAAAAIAAAACAAAAIMCUAAAAAAAQ5Aui"
        "GcCUAAAAAAAQdEEbEcCEAAEAAAAAkgcQgCkAAAAAABAoC4D+p1msqqqqUlVVVQUAwUQAAAAAAADy3yeIATAF"
        "QAAAAACAZBgBIgQIAAAAQGKCCQKACQAAAAAAAAQQAJsecAU="
    ),
    "uastc": (
        "q0tUWCAyMLsNChoKAAAAAAEAAAAIAAAACAAAAAAAAAAAAAAAAQAAAAEAAAACAAAAaAAAACwAAACUAAAAJAAA"
        "AAAAAAAAAAAAAAAAAAAAAAC4AAAAAAAAADAAAAAAAAAAQAAAAAAAAAAsAAAAAAAAAAIAKACmAQIAAwMAABAA"
        "AAAAAAAAAAB/AwAAAAAAAAAA/////x8AAABLVFh3cml0ZXIAQmFzaXMgVW5pdmVyc2FsIDIuMTAAACi1L/0g"
        "QD0BANj3HwDgH3oAF+Af4B8CDwDg/x8C4AEQEBAIQAgEAKAUUMzMbQpgBA=="
    ),
}
FIELDS = np.array([[[255, 0, 0, 255], [0, 255, 0, 255]], [[0, 0, 255, 255], [128, 128, 128, 64]]])


def _pack(document: dict[str, Any], extension: str, **filters: Any) -> None:
    """The square's two views packed as gltfpack writes them: the plain buffer has no bytes."""
    positions = filters.get("positions", SQUARE)
    indices = TRIANGLES.reshape(-1).astype("<u4")
    packed = [
        (meshopt.encode_gltf_buffer(positions, "ATTRIBUTES"), len(positions), 12, "ATTRIBUTES"),
        (meshopt.encode_gltf_buffer(indices, "TRIANGLES"), 6, 2, "TRIANGLES"),
    ]
    data = b"".join(bytes(part[0]) for part in packed)
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    document["buffers"] = [
        {"uri": uri, "byteLength": len(data)},
        {"byteLength": 60, "extensions": {extension: {"fallback": True}}},
    ]
    at = 0
    for view, (part, count, stride, mode) in zip(document["bufferViews"], packed, strict=True):
        view["buffer"] = 1
        view["extensions"] = {
            extension: {
                "buffer": 0, "byteOffset": at, "byteLength": len(part), "byteStride": stride,
                "count": count, "mode": mode,
                **({"filter": filters["filter"]} if mode == "ATTRIBUTES" and filters else {}),
            }
        }  # fmt: skip
        at += len(part)
    document["extensionsRequired"] = document["extensionsUsed"] = [extension]


@pytest.mark.parametrize("extension", ["EXT_meshopt_compression", "KHR_meshopt_compression"])
def test_buffers_packed_by_meshoptimizer(write_square: WriteScene, extension: str) -> None:
    """A packed square is the square."""
    packed = load_scene(write_square(lambda document: _pack(document, extension)))
    plain = load_scene(write_square())
    for one, other in zip(packed.meshes, plain.meshes, strict=True):
        np.testing.assert_allclose(one.world_triangles(), other.world_triangles())
    assert packed.notices == ()


def test_a_filter_is_undone(write_square: WriteScene) -> None:
    """Positions that were rounded to powers of two come back as numbers."""
    encoded = meshopt.encode_filter_exp(SQUARE, 12)
    path = write_square(
        lambda document: _pack(
            document, "EXT_meshopt_compression", positions=encoded, filter="EXPONENTIAL"
        )
    )
    np.testing.assert_allclose(load_scene(path).upper_m, [1, 1, 0], atol=1e-3)


def test_damaged_packed_bytes_give_one_sentence(write_square: WriteScene) -> None:
    """Cut, flipped or wrongly sized, packed bytes end in a sentence or in a scene."""

    def broken(document: dict[str, Any]) -> None:
        _pack(document, "EXT_meshopt_compression")
        document["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["byteLength"] = 7

    with pytest.raises(UserError, match="damaged"):
        load_scene(write_square(broken))


def test_a_packed_view_may_not_swell(write_square: WriteScene) -> None:
    """A declared size beyond what the codec can hold is refused before memory is taken."""

    def huge(document: dict[str, Any]) -> None:
        _pack(document, "EXT_meshopt_compression")
        document["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = 2**31

    with pytest.raises(UserError, match="above the limit"):
        load_scene(write_square(huge), SceneBudget(2**34))


def test_without_the_package_the_line_says_what_to_do(
    write_square: WriteScene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where meshopt is not installed the sentence names it, and a command that unpacks."""
    monkeypatch.setitem(sys.modules, "meshopt", None)
    path = write_square(lambda document: _pack(document, "EXT_meshopt_compression"))
    with pytest.raises(UserError, match=r"vrut-lite\[formats\].*gltf-transform"):
        load_scene(path)


@pytest.mark.parametrize("dtype", ["<i1", "<u1", "<i2", "<u2"])
@pytest.mark.parametrize("normalized", [False, True])
def test_quantised_positions_of_every_type(
    write_square: WriteScene, dtype: str, normalized: bool
) -> None:
    """KHR_mesh_quantization allows bytes and shorts, signed or not, over their range or not."""
    most = np.iinfo(dtype).max
    positions = (SQUARE * most).astype(dtype)

    def edit(document: dict[str, Any]) -> None:
        document["extensionsRequired"] = ["KHR_mesh_quantization"]
        width = positions.dtype.itemsize * 4
        padded = np.zeros((4, 4), dtype)
        padded[:, :3] = positions
        give(
            document,
            POSITION=add_array(document, padded, type="VEC3", normalized=normalized),
        )
        document["bufferViews"][-1]["byteStride"] = width

    upper = load_scene(write_square(edit)).upper_m
    np.testing.assert_allclose(upper, [1, 1, 0] if normalized else [most, most, 0])


def _textured(document: dict[str, Any], data: bytes, **texture: Any) -> None:
    uri = "data:image/ktx2;base64," + base64.b64encode(data).decode()
    add_texture(document, {"uri": uri, "mimeType": "image/ktx2"})
    document["textures"] = [{"extensions": {"KHR_texture_basisu": {"source": 0}}, **texture}]
    document["extensionsRequired"] = ["KHR_texture_basisu"]


@pytest.mark.parametrize("codec", ["etc1s", "uastc"])
def test_pictures_of_basis_universal(write_square: WriteScene, codec: str) -> None:
    """Both codecs of KHR_texture_basisu give back the four fields, within the codec's error."""
    data = base64.b64decode(KTX2[codec])
    image = material_of(load_scene(write_square(lambda d: _textured(d, data)))).baseColorTexture
    pixels = np.asarray(image).astype(int)
    assert pixels.shape == (8, 8, 4)
    np.testing.assert_allclose(pixels[1::5, 1::5], FIELDS, atol=12)


def test_a_plain_picture_goes_before_a_packed_one(write_square: WriteScene) -> None:
    """Where the file has both, the one without loss is read."""

    def edit(document: dict[str, Any]) -> None:
        _textured(document, base64.b64decode(KTX2["etc1s"]), source=1)
        uri = "data:image/png;base64," + base64.b64encode(png_bytes((2, 4))).decode()
        document["images"].append({"uri": uri})

    assert material_of(load_scene(write_square(edit))).baseColorTexture.size == (2, 4)


@pytest.mark.parametrize("cut", [11, 40, 100, 200])
def test_a_cut_picture_gives_one_sentence(write_square: WriteScene, cut: int) -> None:
    """Bytes that end early are refused, in the header and behind it."""
    data = base64.b64decode(KTX2["uastc"])[:cut]
    with pytest.raises(UserError, match="image number 0"):
        load_scene(write_square(lambda document: _textured(document, data)))


def test_a_ktx2_header_counts(write_square: WriteScene) -> None:
    """A claimed size is refused by the header, before any pixel is made."""
    data = bytearray(base64.b64decode(KTX2["uastc"]))
    data[20:28] = (60_000).to_bytes(4, "little") * 2
    with pytest.raises(UserError, match="megapixels"):
        load_scene(write_square(lambda document: _textured(document, bytes(data))))


def test_without_the_package_ktx2_says_what_to_do(
    write_square: WriteScene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where opengl_basisu is not installed the sentence names it and a converter."""
    monkeypatch.setitem(sys.modules, "opengl_basisu", None)
    data = base64.b64decode(KTX2["etc1s"])
    with pytest.raises(UserError, match=r"vrut-lite\[formats\].*ktx extract"):
        load_scene(write_square(lambda document: _textured(document, data)))

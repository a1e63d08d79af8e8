"""Scene files that are damaged, hostile or mistaken end in one sentence, nothing else."""

import base64
import os
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scene_files import SQUARE, TRIANGLES, add_texture, glb_bytes, png_bytes, square_document

from vrut_lite.errors import UserError
from vrut_lite.scene.loading import load_scene

WriteScene = Callable[..., Path]
SQUARE_BYTES = SQUARE.tobytes() + TRIANGLES.tobytes()


def refusal(path: Path) -> str:
    """The sentence with which a file is refused."""
    with pytest.raises(UserError) as refused:
        load_scene(path)
    message = str(refused.value)
    assert "\n" not in message
    assert str(path) in message
    return message


def test_missing_file(tmp_path: Path) -> None:
    """The sentence says that there is no such file."""
    assert "no such file" in refusal(tmp_path / "none.glb")


def test_folder(tmp_path: Path) -> None:
    """A folder is refused, whatever its suffix."""
    folder = tmp_path / "scene.glb"
    folder.mkdir()
    assert "folder" in refusal(folder)


def test_pipe(tmp_path: Path) -> None:
    """A pipe is refused, because a reader would wait for ever."""
    os.mkfifo(tmp_path / "scene.glb")
    assert "regular file" in refusal(tmp_path / "scene.glb")


@pytest.mark.parametrize("name", ["scene", "scene.glb.zip"])
def test_unknown_extension(tmp_path: Path, name: str) -> None:
    """The message lists the formats that are read."""
    (tmp_path / name).write_bytes(b"x")
    assert ".glb, .gltf, .obj" in refusal(tmp_path / name)


@pytest.mark.parametrize(("name", "kind"), [("a.fbx", "FBX"), ("a.blend", "a file of Blender")])
def test_what_blender_reads_names_the_way_out(tmp_path: Path, name: str, kind: str) -> None:
    """Who has such a file learns what it is, and that glTF is the way."""
    (tmp_path / name).write_bytes(b"x")
    assert f"it is {kind}, which is not read" in refusal(tmp_path / name)
    assert "export it as glTF" in refusal(tmp_path / name)


def test_gltf_1_is_called_so(tmp_path: Path) -> None:
    """glTF 1.0 has objects in place of lists, and need not state its version."""
    (tmp_path / "a.gltf").write_text('{"meshes": {"mesh-1": {"primitives": []}}, "nodes": {}}')
    assert "glTF 1.0" in refusal(tmp_path / "a.gltf")
    (tmp_path / "a.glb").write_bytes(struct.pack("<4sIIII", b"glTF", 1, 20, 0, 0))
    assert "glTF 1.0" in refusal(tmp_path / "a.glb")


@pytest.mark.parametrize("name", ["a.gltf", "a.ply", "a.off", "a.stl"])
def test_text_in_utf_16_is_called_so(tmp_path: Path, name: str) -> None:
    """Editors on Windows save it, and no format that is text alone allows it."""
    (tmp_path / name).write_text('{"asset": {"version": "2.0"}}', encoding="utf-16")
    assert "UTF-16" in refusal(tmp_path / name)


def test_wrong_magic(tmp_path: Path) -> None:
    """A GLB begins with 'glTF' (glTF 2.0, section 4.4.2)."""
    (tmp_path / "a.glb").write_bytes(b"PK\3\4" + bytes(100))
    assert "not a GLB" in refusal(tmp_path / "a.glb")


@pytest.mark.parametrize("kept", [0, 3, 11, 19, 60, -1])
def test_truncated_glb(tmp_path: Path, kept: int) -> None:
    """A GLB that is shorter than its header says is refused at any length."""
    whole = glb_bytes(square_document(SQUARE_BYTES), SQUARE_BYTES)
    (tmp_path / "a.glb").write_bytes(whole[:kept])
    refusal(tmp_path / "a.glb")


def test_glb_version(tmp_path: Path) -> None:
    """GLB 1 has another layout."""
    (tmp_path / "a.glb").write_bytes(struct.pack("<4sII", b"glTF", 1, 20) + bytes(8))
    assert "version 1" in refusal(tmp_path / "a.glb")


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", "null", "{'asset': 1}", '{"a":' * 9999, "[" * 200_000, "\xff{}"],
)
def test_invalid_json(tmp_path: Path, text: str) -> None:
    """A document that is not a JSON object, or nested too deeply, is refused."""
    (tmp_path / "a.gltf").write_text(text, encoding="latin-1")
    assert "glTF document" in refusal(tmp_path / "a.gltf")


def test_gltf_1(write_square: WriteScene) -> None:
    """glTF 1.0 is another format."""
    assert "glTF 2" in refusal(write_square(lambda d: d.update(asset={"version": "1.0"})))


@pytest.mark.parametrize("extension", ["KHR_gaussian_splatting", "VND_packing"])
def test_required_extension_is_named(write_square: WriteScene, extension: str) -> None:
    """The sentence names the extension, so that it can be switched off in the export."""
    path = write_square(lambda d: d.update(extensionsRequired=[extension]))
    assert extension in refusal(path)


def test_missing_buffer(write_square: WriteScene) -> None:
    """The missing file is named."""
    path = write_square()
    (path.parent / "square.bin").unlink()
    assert "square.bin" in refusal(path)


def test_short_buffer(write_square: WriteScene) -> None:
    """A buffer file shorter than the document declares is refused as cut short."""
    path = write_square()
    (path.parent / "square.bin").write_bytes(SQUARE_BYTES[:-1])
    assert "cut short" in refusal(path)


def test_missing_image(write_square: WriteScene) -> None:
    """A missing texture is told and left out, so that the rest can be seen."""
    scene = load_scene(write_square(lambda d: add_texture(d, {"uri": "brick.png"})))
    assert "picture brick.png: missing, left out" in scene.notices
    assert scene.meshes[0].mesh.material.baseColorTexture is None


def test_damaged_image(write_square: WriteScene) -> None:
    """A truncated texture is found while loading, not while drawing a frame."""
    path = write_square(lambda d: add_texture(d, {"uri": "brick.png"}))
    (path.parent / "brick.png").write_bytes(png_bytes((64, 64))[:-40])
    assert "damaged" in refusal(path)


def test_image_of_no_known_format(write_square: WriteScene) -> None:
    """Unknown bytes, and formats that run other programs (EPS), are refused."""
    path = write_square(lambda d: add_texture(d, {"uri": "brick.png"}))
    header = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n%%EndComments\nshowpage\n"
    (path.parent / "brick.png").write_bytes(header)
    assert "image" in refusal(path)


def huge_png(side_px: int) -> bytes:
    """A PNG of a few bytes that claims side x side pixels."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        crc = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", crc)

    header = struct.pack(">IIBBBBB", side_px, side_px, 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"\0")) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def huge_jpeg(side_px: int) -> bytes:
    """A JPEG that is all header."""
    frame = struct.pack(">BHHB", 8, side_px, side_px, 3) + bytes.fromhex("011100021100031100")
    return b"\xff\xd8\xff\xc0" + struct.pack(">H", 2 + len(frame)) + frame + b"\xff\xd9"


def huge_bmp(side_px: int) -> bytes:
    """A BMP that is all header."""
    info = struct.pack("<IiiHHIIiiII", 40, side_px, side_px, 1, 24, 0, 0, 0, 0, 0, 0)
    return b"BM" + struct.pack("<IHHI", 54, 0, 0, 54) + info


@pytest.mark.parametrize("make", [huge_png, huge_jpeg, huge_bmp])
@pytest.mark.parametrize("side_px", [9000, 11000, 60_000])
def test_image_that_claims_too_many_pixels(
    write_square: WriteScene, make: Callable[[int], bytes], side_px: int
) -> None:
    """The limit is 64 megapixels, judged by the header: 9000^2 is above it, in each format."""
    path = write_square(lambda d: add_texture(d, {"uri": "big.img"}))
    (path.parent / "big.img").write_bytes(make(side_px))
    assert "64 megapixels" in refusal(path)


def test_huge_image_in_data_uri(write_square: WriteScene) -> None:
    """The limit holds for images inside the document."""
    uri = "data:image/png;base64," + base64.b64encode(huge_png(100_000)).decode()
    path = write_square(lambda d: add_texture(d, {"uri": uri}))
    assert "64 megapixels" in refusal(path)


def test_huge_image_in_buffer_view(write_square: WriteScene) -> None:
    """The limit holds for images inside a buffer."""
    image = huge_png(100_000)

    def edit(document: dict[str, Any]) -> None:
        view = {"buffer": 0, "byteOffset": len(SQUARE_BYTES), "byteLength": len(image)}
        document["bufferViews"].append(view)
        add_texture(document, {"bufferView": 2, "mimeType": "image/png"})

    assert "64 megapixels" in refusal(write_square(edit, SQUARE_BYTES + image))


def test_huge_image_of_obj(write_obj: WriteScene) -> None:
    """The limit holds for OBJ, where trimesh opens the picture."""
    path = write_obj("newmtl paint\nmap_Kd big.png\n")
    (path.parent / "big.png").write_bytes(huge_png(100_000))
    assert "64 megapixels" in refusal(path)


def test_many_large_images(write_square: WriteScene) -> None:
    """Five images just below the limit are together above the 256 megapixels of a scene."""
    side_px = 8000

    def edit(document: dict[str, Any]) -> None:
        names = ("normalTexture", "occlusionTexture", "emissiveTexture")
        document["images"] = [{"uri": f"{i}.png"} for i in range(5)]
        document["textures"] = [{"source": i} for i in range(5)]
        paint = document["materials"][0]
        paint.update({name: {"index": i} for i, name in enumerate(names)})
        paint["pbrMetallicRoughness"] = {
            "baseColorTexture": {"index": 3},
            "metallicRoughnessTexture": {"index": 4},
        }

    path = write_square(edit)
    for number in range(5):
        (path.parent / f"{number}.png").write_bytes(huge_png(side_px))
    assert "256 megapixels" in refusal(path)


FOREIGN = [
    "../secret.bin",
    "sub/../../secret.bin",
    "%2e%2e%2fsecret.bin",
    "..%2Fsecret.bin",
    "%2E%2E/secret.bin",
    "/etc/passwd",
    "~/secret.bin",
    "file:///etc/passwd",
    "file:secret.bin",
    "C:/secret.bin",
    "C:%5Csecret.bin",
    "..\\secret.bin",
    "%5C%5Cserver%5Cshare%5Csecret.bin",
    "http://example.com/a.bin",
    "https://example.com/a.bin",
    "HTTPS://example.com/a.bin",
    "ftp://example.com/a.bin",
    "//example.com/a.bin",
    "",
    "a%00b",
    "%ff%fe",
    "x" * 5000,
]


@pytest.mark.parametrize("uri", FOREIGN)
def test_buffers_keep_to_the_folder(write_square: WriteScene, tmp_path: Path, uri: str) -> None:
    """No buffer outside the scene's folder is read, even where the file exists and would fit."""
    (tmp_path / "secret.bin").write_bytes(SQUARE_BYTES)
    assert "it names" in refusal(write_square(lambda d: d["buffers"][0].update(uri=uri)))


def told_without_picture(path: Path) -> str:
    """What a scene that opens without its picture says of it."""
    scene = load_scene(path)
    assert all(place.mesh.material.baseColorTexture is None for place in scene.meshes)
    (notice,) = (line for line in scene.notices if line.startswith("picture "))
    assert notice.endswith("left out")
    return notice


@pytest.mark.parametrize("uri", FOREIGN)
def test_pictures_of_gltf_keep_to_the_folder(
    write_square: WriteScene, tmp_path: Path, uri: str
) -> None:
    """A scene opens without a picture that lies elsewhere, and says so; unused ones say nothing."""
    (tmp_path / "secret.bin").write_bytes(png_bytes())
    told_without_picture(write_square(lambda d: add_texture(d, {"uri": uri})))
    unused = write_square(lambda d: d.update(images=[{"uri": uri}]))
    assert not any("left out" in line for line in load_scene(unused).notices)


@pytest.mark.parametrize("name", [name for name in FOREIGN if name and "%" not in name])
def test_pictures_of_mtl_keep_to_the_folder(
    write_obj: WriteScene, tmp_path: Path, name: str
) -> None:
    """An MTL's picture that lies elsewhere is left out, options before its path or not."""
    (tmp_path / "secret.bin").write_bytes(png_bytes())
    for options in ("", "-clamp on -s 1 1 1 "):
        told_without_picture(write_obj(f"newmtl paint\nmap_Kd {options}{name}\n"))


def test_mtllib_keeps_to_its_folder(write_obj: WriteScene, tmp_path: Path) -> None:
    """Of a path that climbs out, the file of that name beside the OBJ is the material library."""
    path = write_obj("newmtl paint\n")
    (path.parent / "other.mtl").write_text("newmtl paint\n")
    (tmp_path / "else.mtl").write_text("newmtl paint\n")
    text = path.read_text()
    path.write_text(text.replace("square.mtl", "../other.mtl"))
    assert not any("material" in line for line in load_scene(path).notices)
    path.write_text(text.replace("square.mtl", "../else.mtl"))
    assert load_scene(path).notices[0] == (
        "material library ../else.mtl: outside the scene's folder, grey instead"
    )


@pytest.mark.parametrize("kind", ["buffer", "image", "texture of OBJ", "folder"])
def test_links_that_leave_the_folder(
    write_square: WriteScene, write_obj: WriteScene, tmp_path: Path, kind: str
) -> None:
    """Nothing is read through a symbolic link that leaves the folder."""
    (tmp_path / "outside").mkdir()
    secret = tmp_path / "outside" / "secret"
    secret.write_bytes(SQUARE_BYTES if kind == "buffer" else png_bytes())
    if kind == "texture of OBJ":
        path = write_obj("newmtl paint\nmap_Kd link\n")
    elif kind == "buffer":
        path = write_square(lambda d: d["buffers"][0].update(uri="link"))
    else:
        name = "link" if kind == "image" else "link/secret"
        path = write_square(lambda d: add_texture(d, {"uri": name}))
    (path.parent / "link").symlink_to(secret.parent if kind == "folder" else secret)
    if kind == "buffer":
        assert "leaves the scene's folder" in refusal(path)
    else:
        assert "outside the scene's folder" in told_without_picture(path)


@pytest.mark.parametrize("uri", ["data:,plain", "data:;base64,@@@", "data:;base64"])
def test_damaged_data_uri(write_square: WriteScene, uri: str) -> None:
    """A data URI is base64 or refused."""
    assert "data URI" in refusal(write_square(lambda d: d["buffers"][0].update(uri=uri)))


def test_no_triangles(write_square: WriteScene) -> None:
    """A scene of points alone is refused."""

    def edit(document: dict[str, Any]) -> None:
        document["meshes"][0]["primitives"][0]["mode"] = 0

    assert "no triangles" in refusal(write_square(edit))


def test_empty_scene(write_square: WriteScene) -> None:
    """A scene without nodes has nothing to show."""
    assert "no triangles" in refusal(write_square(lambda d: d.update(scenes=[{}])))


def test_empty_obj(tmp_path: Path) -> None:
    """An OBJ file without faces has nothing to show."""
    (tmp_path / "a.obj").write_text("# nothing\nv 0 0 0\n")
    assert "no triangles" in refusal(tmp_path / "a.obj")


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_vertices_that_are_not_finite(write_square: WriteScene, value: float) -> None:
    """A single bad vertex is refused: it would spoil the bounds and the default camera."""
    positions = SQUARE.copy()
    positions[2, 1] = value
    assert "finite" in refusal(write_square(data=positions.tobytes() + TRIANGLES.tobytes()))


@pytest.mark.parametrize("word", ["nan", "inf", "1e999"])
def test_obj_vertices_that_are_not_finite(write_obj: WriteScene, word: str) -> None:
    """The same in OBJ."""
    vertices = f"v 0 0 0\nv 1 0 0\nv 1 {word} 0\nv 0 1 0"
    assert "finite" in refusal(write_obj(vertices=vertices))


def test_vertices_too_far_away(write_square: WriteScene) -> None:
    """A scene of 1e30 m is damage or another unit; 10 000 km is the limit."""
    data = (SQUARE * np.float32(1e30)).tobytes() + TRIANGLES.tobytes()
    assert "metres" in refusal(write_square(data=data))


def test_index_out_of_range(write_square: WriteScene) -> None:
    """Vertex 4 of four does not exist."""
    indices = np.array([[0, 1, 2], [0, 2, 4]], "<u2")
    assert "vertex 4" in refusal(write_square(data=SQUARE.tobytes() + indices.tobytes()))


@pytest.mark.parametrize("face", ["f 1 2 5", "f 0 1 2", "f -1 -2 -5", "f 1 2 x", "f 1 2 9e9"])
def test_obj_index_out_of_range(write_obj: WriteScene, face: str) -> None:
    """OBJ indices start at 1; negative ones count back from the current line."""
    assert "export it again" in refusal(write_obj(faces=face))


@pytest.mark.parametrize("count", [5, 10**6, 2**31])
def test_count_beyond_the_file(write_square: WriteScene, count: int) -> None:
    """A count is compared with the available bytes before memory is taken."""
    path = write_square(lambda d: d["accessors"][0].update(count=count))
    assert "count" in refusal(path)


def test_huge_count_without_data(write_square: WriteScene) -> None:
    """An accessor without a buffer view means zeros; two thousand million are refused."""

    def edit(document: dict[str, Any]) -> None:
        document["accessors"][0] = {"componentType": 5126, "count": 2**31, "type": "VEC3"}

    assert "limit" in refusal(write_square(edit))


def test_many_placed_triangles(write_square: WriteScene) -> None:
    """A small file that places one mesh too often is refused."""

    def edit(document: dict[str, Any]) -> None:
        document["accessors"][1] = {"componentType": 5125, "count": 3_000_000, "type": "SCALAR"}
        document["nodes"] = [{"mesh": 0} for _ in range(40)]
        document["scenes"] = [{"nodes": list(range(40))}]

    assert "limit" in refusal(write_square(edit))


@pytest.mark.parametrize(
    "edit",
    [
        lambda d: d["nodes"][0].update(mesh=7),
        lambda d: d["scenes"][0].update(nodes=[3]),
        lambda d: d.update(scene=2),
        lambda d: d["meshes"][0]["primitives"][0].update(material=4),
        lambda d: d["meshes"][0]["primitives"][0].update(indices=9),
        lambda d: d["accessors"][0].update(bufferView=5),
        lambda d: d["bufferViews"][0].update(buffer=5),
        lambda d: d["bufferViews"][0].update(byteLength=10**9),
        lambda d: d["bufferViews"][0].update(byteStride=4),
        lambda d: d["nodes"][0].update(mesh=-1),
        lambda d: d["nodes"][0].update(children=[0]),
        lambda d: d["accessors"][0].update(count="4"),
        lambda d: d["accessors"][0].update(count=-4),
        lambda d: d["accessors"][0].update(componentType=5124),
        lambda d: d["accessors"][0].update(type="VEC2", count=4),
        lambda d: d["accessors"][1].update(componentType=5126, count=3),
        lambda d: d["nodes"][0].update(matrix=[1.0] * 15),
        lambda d: d.update(meshes={}),
        lambda d: d["buffers"][0].pop("uri"),
        lambda d: d["meshes"][0]["primitives"][0]["attributes"].update(NORMAL=1),
        lambda d: d["meshes"][0]["primitives"][0]["attributes"].update(TEXCOORD_0=0),
    ],
)
def test_references_that_do_not_hold(
    write_square: WriteScene, edit: Callable[[dict[str, Any]], None]
) -> None:
    """Invalid references, cyclic nodes and wrong types are refused."""
    refusal(write_square(edit))


def test_wide_obj_numbers(write_obj: WriteScene) -> None:
    """Text that is not OBJ at all is refused."""
    path = write_obj()
    path.write_bytes(bytes(range(256)) * 4)
    refusal(path)


def test_message_is_short_for_a_long_name(write_square: WriteScene) -> None:
    """A hostile name is shortened and its control characters are escaped."""
    path = write_square(lambda d: d["buffers"][0].update(uri="\x1b[2J" + "y" * 9000))
    message = refusal(path).replace(str(path), "")
    assert len(message) < 250
    assert "\x1b" not in message

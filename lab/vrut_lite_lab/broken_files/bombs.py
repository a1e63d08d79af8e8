"""Small scene files that ask for much: each names a few bytes often, or declares what is not there.

A bomb is made of a number, so that its files can be doubled and the time they take compared.
"""

import base64
import json
import struct
import zlib
from collections.abc import Callable
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image

Files = dict[str, bytes]
_TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4").tobytes()
_OBJ_HEAD = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n"
_FACE = "f 1 2 3\n"


def png(width: int, height: int, *, depth: int = 8, colour: int = 2, rest: int = 0) -> bytes:
    """A whole PNG of zeros; colour 0 is grey, 2 RGB, 3 a palette with transparency, 6 RGBA."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        crc = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", crc)

    bits = {0: 1, 2: 3, 3: 1, 6: 4}[colour] * depth
    packer = zlib.compressobj(9)
    row = bytes(1 + (width * bits + 7) // 8)
    body = b"".join(packer.compress(row) for _ in range(height)) + packer.flush()
    parts = [chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0))]
    if colour == 3:
        parts += [chunk(b"PLTE", bytes(3)), chunk(b"tRNS", b"\x80")]
    parts += [chunk(b"IDAT", body), chunk(b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts) + bytes(rest)


def encoded(side_px: int, kind: str, **options: Any) -> bytes:
    """A black picture of one of Pillow's formats."""
    out = BytesIO()
    Image.new("RGB", (side_px, side_px)).save(out, kind, **options)
    return out.getvalue()


def document(**parts: Any) -> dict[str, Any]:
    """A glTF document of one triangle in `a.bin`, some of its parts replaced."""
    return {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(_TRIANGLE), "uri": "a.bin"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(_TRIANGLE)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}],
        **parts,
    }


def gltf(parts: dict[str, Any], **beside: bytes) -> Files:
    """`a.gltf` of a document with these parts, its buffer, and files beside it (a_png: a.png)."""
    others = {name.replace("_", "."): data for name, data in beside.items()}
    text = json.dumps(document(**parts), separators=(",", ":")).encode()
    return {"a.gltf": text, "a.bin": _TRIANGLE, **others}


def obj(text: str, mtl: str = "newmtl m\nKd 1 1 1\n", **beside: bytes) -> Files:
    """`a.obj` of some lines after four vertices, `a.mtl`, and files beside them."""
    others = {name.replace("_", "."): data for name, data in beside.items()}
    return {"a.obj": (_OBJ_HEAD + text).encode(), "a.mtl": mtl.encode(), **others}


def _spellings(name: str, count: int) -> list[str]:
    """Names of one file: with dots, doubled slashes and per cent signs."""
    odd = "".join(f"%{ord(letter):02x}" for letter in name)
    ways = ["", "./", ".//", ".///"]
    return [ways[n % 4] + "./" * (n // 8) + (odd if n // 4 % 2 else name) for n in range(count)]


def _pictures(images: list[dict[str, Any]], **parts: Any) -> dict[str, Any]:
    """Parts that name these images, and a mesh that wears each of them."""
    numbers = range(len(images))
    worn = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": n}}} for n in numbers]
    primitives = [{"attributes": {"POSITION": 0}, "material": n} for n in numbers]
    return {
        "images": images,
        "textures": [{"source": n} for n in numbers],
        "materials": worn,
        "meshes": [{"primitives": primitives}],
        **parts,
    }


def _view(data: bytes, **more: Any) -> dict[str, Any]:
    """Parts that add a buffer view of bytes in a data URI; the triangle's stays number 0."""
    uri = "data:;base64," + base64.b64encode(data).decode()
    base = document()
    return {
        "buffers": [*base["buffers"], {"byteLength": len(data), "uri": uri}],
        "bufferViews": [*base["bufferViews"], {"buffer": 1, "byteLength": len(data), **more}],
    }


def _accessor(count: int, **more: Any) -> dict[str, Any]:
    return {"componentType": 5126, "count": count, "type": "VEC3", **more}


def _overlapping_arrays(n: int) -> Files:
    data = bytes(100 * n)
    accessors = [_accessor(n, bufferView=1, byteOffset=4 * k) for k in range(n)]
    primitives = [{"attributes": {"POSITION": k}} for k in range(n)]
    return gltf({**_view(data), "accessors": accessors, "meshes": [{"primitives": primitives}]})


def _overlapping_pictures(n: int) -> Files:
    data = png(1, 1, rest=100 * n)
    parts = _view(data)
    ends = [{"buffer": 1, "byteLength": len(data) - k} for k in range(n)]
    parts["bufferViews"] = [parts["bufferViews"][0], *ends]
    return gltf({**parts, **_pictures([{"bufferView": 1 + k} for k in range(n)])})


def _one_view(n: int) -> Files:
    return gltf({**_view(png(1, 1, rest=50 * n)), **_pictures([{"bufferView": 1}] * n)})


def _chain(n: int) -> Files:
    nodes: list[dict[str, Any]] = [{"children": [k + 1]} for k in range(n - 1)]
    return gltf({"nodes": [*nodes, {"mesh": 0}]})


def _colours(n: int) -> Files:
    colours = {"componentType": 5121, "count": n, "type": "MAT4", "normalized": True}
    primitive = {"attributes": {"POSITION": 0, "COLOR_0": 1}}
    accessors = [_accessor(3, bufferView=0), colours]
    return gltf({"accessors": accessors, "meshes": [{"primitives": [primitive]}]})


def _sparse(n: int) -> Files:
    sparse = {
        "count": 1,
        "indices": {"bufferView": 1, "componentType": 5121},
        "values": {"bufferView": 0},
    }
    return gltf({**_view(b"\1"), "accessors": [_accessor(n, sparse=sparse)]})


def _few_vertices(n: int) -> Files:
    """One byte for each triangle of a strip, all over the same three vertices."""
    parts = _view((np.arange(n) % 3).astype(np.uint8).tobytes())
    index = {"bufferView": 1, "componentType": 5121, "count": n, "type": "SCALAR"}
    primitive = {"attributes": {"POSITION": 0}, "indices": 1, "mode": 5}
    accessors = [_accessor(3, bufferView=0), index]
    return gltf({**parts, "accessors": accessors, "meshes": [{"primitives": [primitive]}]})


def _primitives(n: int) -> Files:
    """Primitives of one vertex array, each with a triangle of its own."""
    index = [
        {"bufferView": 1, "byteOffset": k, "componentType": 5121, "count": 3, "type": "SCALAR"}
        for k in range(n)
    ]
    primitives = [{"attributes": {"POSITION": 0}, "indices": 1 + k} for k in range(n)]
    accessors = [_accessor(3, bufferView=0), *index]
    parts = _view(bytes([0, 1, 2] * (n // 3 + 2)))
    return gltf({**parts, "accessors": accessors, "meshes": [{"primitives": primitives}]})


def _draco(n: int) -> Files:
    """A head that declares n triangles, and nothing after it."""

    def varint(value: int) -> bytes:
        return bytes([value & 0x7F | (0x80 if value > 0x7F else 0)]) + (
            varint(value >> 7) if value > 0x7F else b""
        )

    packed = b"DRACO\2\2\1\0\0\0" + varint(n) + varint(3 * n) + bytes(64)
    extension = {"KHR_draco_mesh_compression": {"bufferView": 1, "attributes": {"POSITION": 0}}}
    primitive = {"attributes": {"POSITION": 0}, "extensions": extension}
    accessors = [_accessor(3 * n)]
    return gltf({**_view(packed), "accessors": accessors, "meshes": [{"primitives": [primitive]}]})


def _scans(n: int) -> Files:
    """A progressive JPEG, its last scan again and again."""
    data = encoded(1000, "JPEG", progressive=True)
    last = data[data.rindex(b"\xff\xda") : -2]
    return gltf(_pictures([{"uri": "a.jpg"}]), a_jpg=data[:-2] + last * n + b"\xff\xd9")


def _large_pictures(n: int) -> Files:
    names = [f"{k}.png" for k in range(n)]
    files = gltf(_pictures([{"uri": name} for name in names]))
    return files | dict.fromkeys(names, png(7000, 7000))


def _mtl_pictures(n: int) -> Files:
    lines = [f"newmtl m{k}\nmap_Kd {'./' * (k % 200)}a.png\n" for k in range(n)]
    faces = "".join(f"usemtl m{k}\n{_FACE}" for k in range(min(n, 1000)))
    return obj(faces, "".join(lines), a_png=png(1000, 1000))


# Each kind with a number that makes some ten thousand to a million bytes of it.
BOMBS: dict[str, tuple[Callable[[int], Files], int]] = {
    "buffers: the file itself": (
        lambda n: gltf({"buffers": [{"byteLength": 0, "uri": "a.gltf"}] * n}),
        20_000,
    ),
    "buffers: spellings of a file": (
        lambda n: gltf({"buffers": [{"byteLength": 0, "uri": u} for u in _spellings("a.bin", n)]}),
        2_000,
    ),
    "buffers: a data URI": (
        lambda n: gltf({"buffers": [{"byteLength": 3, "uri": "data:;base64,AAAA"}] * n}),
        20_000,
    ),
    "images: one view": (_one_view, 20_000),
    "images: overlapping views": (_overlapping_pictures, 5_000),
    "images: spellings of a file": (
        lambda n: gltf(
            _pictures([{"uri": uri} for uri in _spellings("a.png", n)]),
            a_png=png(2000, 2000),
        ),
        2_000,
    ),
    "images: five of 49 megapixels": (_large_pictures, 5),
    "image: 49 megapixels of 16 bits": (
        lambda n: gltf(_pictures([{"uri": "a.png"}]), a_png=png(n, n, depth=16, colour=0)),
        7_000,
    ),
    "image: 49 megapixels of a palette": (
        lambda n: gltf(_pictures([{"uri": "a.png"}]), a_png=png(n, n, depth=1, colour=3)),
        7_000,
    ),
    "image: 49 megapixels of JPEG": (
        lambda n: gltf(_pictures([{"uri": "a.jpg"}]), a_jpg=encoded(n, "JPEG", progressive=True)),
        7_000,
    ),
    "image: 49 megapixels of WebP": (
        lambda n: gltf(_pictures([{"uri": "a.webp"}]), a_webp=encoded(n, "WEBP", method=0)),
        7_000,
    ),
    "image: scans of a JPEG": (_scans, 5_000),
    "arrays: zero vertices": (lambda n: gltf({"accessors": [_accessor(n)]}), 16_000_000),
    "arrays: zero colours": (_colours, 49_000_000),
    "arrays: a sparse one": (_sparse, 16_000_000),
    "arrays: overlapping": (_overlapping_arrays, 2_000),
    "triangles: a strip of three vertices": (_few_vertices, 1_000_000),
    "triangles: Draco's": (_draco, 5_000_000),
    "primitives: the same": (
        lambda n: gltf({"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}] * n}]}),
        20_000,
    ),
    "primitives: of one array": (_primitives, 5_000),
    "nodes: of one mesh": (lambda n: gltf({"nodes": [{"mesh": 0}] * n}), 100_000),
    "nodes: of many primitives": (
        lambda n: gltf(
            {
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}] * n}],
                "nodes": [{"mesh": 0}] * n,
            }
        ),
        1_000,
    ),
    "nodes: empty": (lambda n: gltf({"nodes": [{"mesh": 0}, *[{}] * n]}), 150_000),
    "nodes: a chain": (_chain, 100_000),
    "OBJ: empty lines in the MTL": (
        lambda n: obj("usemtl m\n" + _FACE, "newmtl m" + "\n" * n),
        10**6,
    ),
    "OBJ: spaces in a map": (
        lambda n: obj("usemtl m\n" + _FACE, "newmtl m\nmap_Kd a" + " " * n + "b\n"),
        10**6,
    ),
    "OBJ: options of a map": (
        lambda n: obj("usemtl m\n" + _FACE, "newmtl m\nmap_Kd" + " -s 1" * n + "\n"),
        200_000,
    ),
    "OBJ: spellings of a picture": (_mtl_pictures, 5_000),
    "OBJ: newmtl": (
        lambda n: obj(_FACE, "".join(f"newmtl m{k}\nKd 1 1 1\n" for k in range(n))),
        50_000,
    ),
    "OBJ: usemtl of two": (
        lambda n: obj("".join(f"usemtl m{k % 2}\n{_FACE}" for k in range(n))),
        100_000,
    ),
    "OBJ: usemtl of many": (
        lambda n: obj("".join(f"usemtl m{k}\n{_FACE}" for k in range(n))),
        5_000,
    ),
    "OBJ: o, g and s": (
        lambda n: obj("".join(f"o a{k}\ng b{k}\ns {k}\n{_FACE}" for k in range(n))),
        50_000,
    ),
    "OBJ: continued lines": (lambda n: obj("f 1 2 3" + " \\\n4" * n + "\n"), 200_000),
    "OBJ: one long face": (lambda n: obj("f" + " 1 2 3" * n + "\n"), 200_000),
    "OBJ: faces of other lengths": (
        lambda n: obj("".join("f" + " 1 2 3 4" * k + "\n" for k in range(1, n))),
        1_000,
    ),
    "OBJ: corners of other forms": (
        lambda n: obj("vt 0 0\nvn 0 0 1\n" + "f 1/1 2//1 3/1/1\nf 1/ 2 3\n" * n),
        50_000,
    ),
    "OBJ: faces that count back": (lambda n: obj("f -1 -2 -3\nv 0 0 0\n" * n), 50_000),
    "OBJ: words": (lambda n: obj(_FACE + "mtllib b.mtl\ncstype x\n\n \n" * n), 100_000),
}


def bomb(kind: str, number: int | None = None) -> tuple[str, Files]:
    """The scene's name and all its files, of the given number or the kind's own."""
    make, usual = BOMBS[kind]
    files = make(usual if number is None else number)
    return next(iter(files)), files

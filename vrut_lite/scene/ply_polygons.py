"""PLY and OFF with polygons as files with triangles: trimesh cuts polygons as fans, at best."""

import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.ear_clipping import polygon_triangles

_ELEMENT = re.compile(rb"element +(\w+) +(\d+)\s*\n((?:(?:property|comment) [^\n]*\n)*)")
_PROPERTY = re.compile(rb"property +(list +\w+ +\w+|\w+) +(\w+)")
_ORDERS = {b"binary_little_endian": "<", b"binary_big_endian": ">"}
_TYPES = {
    **dict.fromkeys((b"char", b"int8"), "i1"),
    **dict.fromkeys((b"uchar", b"uint8"), "u1"),
    **dict.fromkeys((b"short", b"int16"), "i2"),
    **dict.fromkeys((b"ushort", b"uint16"), "u2"),
    **dict.fromkeys((b"int", b"int32"), "i4"),
    **dict.fromkeys((b"uint", b"uint32"), "u4"),
    **dict.fromkeys((b"float", b"float32"), "f4"),
    **dict.fromkeys((b"double", b"float64"), "f8"),
}
_AXES = (b"x", b"y", b"z")


class _Element(NamedTuple):
    """An element of a PLY's head: its properties' types and names; where its count stands."""

    name: bytes
    rows: int
    properties: list[tuple[bytes, bytes]]
    count_span: tuple[int, int]

    @property
    def is_list(self) -> bool:
        """Whether a property of it is a list."""
        return any(kind.startswith(b"list") for kind, _ in self.properties)


def triangulated_ply(data: bytes) -> bytes:
    """The file with each polygon cut into triangles, concave ones by ear clipping.

    Triangles alone, and files whose faces have other properties than one list, or whose vertices
    do not come first, stay as they are.

    Raises:
        ValueError: its faces reach beyond its end, or its types are unknown.
    """
    head_bytes = data.index(b"\n", data.index(b"end_header")) + 1
    head = data[:head_bytes].replace(b"\r\n", b"\n")
    elements = [
        _Element(one[1], int(one[2]), _PROPERTY.findall(one[3]), one.span(2))
        for one in _ELEMENT.finditer(head)
    ]
    if [one.name for one in elements[:2]] != [b"vertex", b"face"]:
        return data
    vertex, face = elements[:2]
    names = [name for _, name in vertex.properties]
    if vertex.is_list or len(face.properties) != 1 or not face.is_list:
        return data
    if not set(_AXES) <= set(names):
        return data
    order = next((mark for name, mark in _ORDERS.items() if name in head), None)
    body = data[head_bytes:]
    if order is None:
        lines = [line for line in body.splitlines() if line.strip()]
        end = vertex.rows + face.rows
        triangles = _text_triangles(
            lines[: vertex.rows], [names.index(axis) for axis in _AXES], lines[vertex.rows : end]
        )
        if triangles is None:
            return data
        rows = [b"3 %d %d %d" % tuple(one) for one in triangles.tolist()]
        cut = b"\n".join([*lines[: vertex.rows], *rows, *lines[end:], b""])
    else:
        rows_of = np.dtype(
            [(name.decode(), order + _TYPES[kind]) for kind, name in vertex.properties]
        )
        start = vertex.rows * rows_of.itemsize
        if start > len(body):
            raise ValueError(f"it ends before its {vertex.rows:,} vertices do")
        rows_of_vertices = np.frombuffer(body, rows_of, vertex.rows)
        points = np.stack([rows_of_vertices[axis.decode()] for axis in _AXES], axis=1)
        size_type, index_type = (
            np.dtype(order + _TYPES[word]) for word in face.properties[0][0].split()[1:]
        )
        triangles, end = _binary_triangles(
            body, start, face.rows, size_type, index_type, points.astype(np.float64)
        )
        if triangles is None:
            return data
        packed = np.empty(len(triangles), [("size", size_type), ("index", index_type, 3)])
        packed["size"], packed["index"] = 3, triangles
        cut = body[:start] + packed.tobytes() + body[end:]
    first, last = face.count_span
    return head[:first] + str(len(triangles)).encode() + head[last:] + cut


def triangulated_off(data: bytes) -> bytes:
    """The OFF without comments, and with each polygon cut into triangles.

    trimesh takes numbers of comments for vertices.

    Raises:
        ValueError: it has no counts, or a face names no vertex.
    """
    text = re.sub(rb"#[^\n]*", b"", data)
    head, body = re.split(rb"OFF\b", text, maxsplit=1)
    lines = [line for line in body.splitlines() if line.strip()]
    if not lines or len(lines[0].split()) < 2:
        raise ValueError("it has no counts of vertices and faces")
    vertices, faces = (int(word) for word in lines[0].split()[:2])
    points, polygons = lines[1 : 1 + vertices], lines[1 + vertices : 1 + vertices + faces]
    triangles = _text_triangles(points, [0, 1, 2], polygons)
    if triangles is not None:
        polygons = [b"3 %d %d %d" % tuple(one) for one in triangles.tolist()]
    counts = b"%d %d 0" % (vertices, len(polygons))
    return b"\n".join([head.strip() + b"OFF", counts, *points, *polygons, b""])


def _text_triangles(
    vertices: list[bytes], axes: list[int], faces: list[bytes]
) -> NDArray[np.int64] | None:
    """Triangles (F, 3) of polygons in lines of text; None for triangles alone."""
    words = [line.split() for line in faces]
    counts = np.array([int(line[0]) for line in words], np.int64)
    if (counts == 3).all():
        return None
    if any(len(line) <= count for line, count in zip(words, counts.tolist(), strict=True)):
        raise ValueError("a face has fewer corners than it counts")
    places = np.array([[line.split()[axis] for axis in axes] for line in vertices], np.float64)
    corners = [word for line in words for word in line[1 : int(line[0]) + 1]]
    return polygon_triangles(places, counts, np.array(corners, np.int64))


def _binary_triangles(
    body: bytes,
    start: int,
    count: int,
    size_type: np.dtype,
    index_type: np.dtype,
    points: FloatArray,
) -> tuple[NDArray[np.int64] | None, int]:
    """Triangles (F, 3) of `count` polygons, and where they end; None for triangles alone."""
    sizes, starts, at = np.empty(count, np.int64), np.empty(count, np.int64), start
    for number in range(count):
        if at + size_type.itemsize > len(body):
            raise ValueError(f"it ends before face {number + 1:,} of {count:,}")
        size = int(np.frombuffer(body, size_type, 1, at)[0])
        sizes[number], starts[number] = size, at + size_type.itemsize
        at += size_type.itemsize + size * index_type.itemsize
    if count == 0 or at > len(body) or (sizes == 3).all():
        return None, at
    corner = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    places = np.repeat(starts, sizes) + corner * index_type.itemsize
    bytes_of = np.frombuffer(body, np.uint8)
    picked = bytes_of[places[:, None] + np.arange(index_type.itemsize)]
    indices = np.ascontiguousarray(picked).view(index_type)[:, 0].astype(np.int64)
    return polygon_triangles(points, sizes, indices), at

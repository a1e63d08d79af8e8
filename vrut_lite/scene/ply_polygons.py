"""Binary PLY with polygons as one with triangles: trimesh reads faces of one length alone."""

import re

import numpy as np

_ELEMENT = re.compile(rb"element +(\w+) +(\d+)\s*\n((?:(?:property|comment) [^\n]*\n)*)")
_PROPERTY = re.compile(rb"property +(list +\w+ +\w+|\w+) +\w+")
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


def triangulated_ply(data: bytes) -> bytes:
    """The file with each polygon as a fan of triangles.

    Text, triangles alone, and files whose faces have other properties than one list stay as they
    are.

    Raises:
        ValueError: its faces reach beyond its end, or its types are unknown.
    """
    head_bytes = data.index(b"\n", data.index(b"end_header")) + 1
    order = next((mark for name, mark in _ORDERS.items() if name in data[:head_bytes]), None)
    start = head_bytes
    for element in _ELEMENT.finditer(data[:head_bytes]):
        count, kinds = int(element[2]), _PROPERTY.findall(element[3])
        is_list = [kind.startswith(b"list") for kind in kinds]
        if order is None or (any(is_list) and (element[1] != b"face" or len(kinds) > 1)):
            return data
        if any(is_list):
            size_type, index_type = (np.dtype(order + _TYPES[w]) for w in kinds[0].split()[1:])
            faces, end = _fans(data, start, count, size_type, index_type)
            if faces is None:
                return data
            rows = np.empty(len(faces), [("size", size_type), ("index", index_type, 3)])
            rows["size"], rows["index"] = 3, faces
            first, last = element.span(2)
            head = data[:first] + str(len(faces)).encode() + data[last:head_bytes]
            return head + data[head_bytes:start] + rows.tobytes() + data[end:]
        start += count * sum(np.dtype(_TYPES[kind]).itemsize for kind in kinds)
    return data


def _fans(
    data: bytes, start: int, count: int, size_type: np.dtype, index_type: np.dtype
) -> tuple[np.ndarray | None, int]:
    """Triangles (F, 3) of `count` polygons in their order, and where they end.

    None for triangles alone.
    """
    sizes, starts, at = np.empty(count, np.int64), np.empty(count, np.int64), start
    for number in range(count):
        if at + size_type.itemsize > len(data):
            raise ValueError(f"it ends before face {number + 1:,} of {count:,}")
        size = int(np.frombuffer(data, size_type, 1, at)[0])
        sizes[number], starts[number] = size, at + size_type.itemsize
        at += size_type.itemsize + size * index_type.itemsize
    if count == 0 or at > len(data) or (sizes == 3).all():
        return None, at
    triangles = np.maximum(sizes - 2, 0)
    face = np.repeat(np.arange(count), triangles)
    within = np.arange(len(face)) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    corners = np.stack([np.zeros_like(within), within + 1, within + 2], axis=1)
    places = starts[face, None] + corners * index_type.itemsize
    bytes_of = np.frombuffer(data, np.uint8)
    picked = bytes_of[places[..., None] + np.arange(index_type.itemsize)]
    return np.ascontiguousarray(picked).view(index_type)[..., 0], at

"""Reads the declared size of a Draco mesh before anything is unpacked.

The layout is that of the Draco bitstream specification, version 2.2, the one that glTF allows.
"""

from typing import NamedTuple

from vrut_lite.scene.scene_file_error import SceneFileError

_MAGIC, _VERSION = b"DRACO", (2, 2)
_MESH, _SEQUENTIAL, _EDGEBREAKER = 1, 0, 1
_HAS_METADATA = 0x8000
_DEEPEST_METADATA = 32


class DracoCounts(NamedTuple):
    """Numbers of triangles, and of vertices before the decoder splits those at seams."""

    faces: int
    points: int


def read_draco_counts(packed: bytes) -> DracoCounts:
    """The declared counts.

    Raises:
        SceneFileError: if the bytes do not begin as a mesh of version 2.2 does.
    """
    try:
        return _counts(_Reader(packed))
    except (IndexError, ValueError) as fault:
        raise SceneFileError("its Draco data are damaged; export it again") from fault


def _counts(reader: "_Reader") -> DracoCounts:
    if reader.skip(5) != _MAGIC:
        raise ValueError("no Draco data")
    version = (reader.byte(), reader.byte())
    if version != _VERSION:
        raise SceneFileError(
            f"its Draco data are of version {version[0]}.{version[1]}, and glTF has 2.2; "
            "export it again"
        )
    if reader.byte() != _MESH:
        raise SceneFileError("its Draco data hold no triangles; export it again")
    method = reader.byte()
    flags = reader.byte() | reader.byte() << 8
    if flags & _HAS_METADATA:
        _skip_metadata(reader)
    if method == _SEQUENTIAL:
        return DracoCounts(reader.number(), reader.number())
    if method != _EDGEBREAKER:
        raise ValueError("unknown method")
    reader.byte()  # How the edges are traversed.
    points = reader.number()
    return DracoCounts(reader.number(), points)


def _skip_metadata(reader: "_Reader") -> None:
    for _ in range(reader.number()):
        reader.number()  # The attribute's number.
        _skip_entries(reader, 0)
    _skip_entries(reader, 0)


def _skip_entries(reader: "_Reader", depth: int) -> None:
    if depth > _DEEPEST_METADATA:
        raise ValueError("metadata without end")
    for _ in range(reader.number()):
        reader.skip(reader.byte())
        reader.skip(reader.number())
    for _ in range(reader.number()):
        reader.skip(reader.byte())
        _skip_entries(reader, depth + 1)


class _Reader:
    """Reads bytes in order; raises IndexError beyond the end."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    def byte(self) -> int:
        self._at += 1
        return self._data[self._at - 1]

    def skip(self, count: int) -> bytes:
        if count > len(self._data) - self._at:
            raise IndexError("beyond the end")
        self._at += count
        return self._data[self._at - count : self._at]

    def number(self) -> int:
        """Seven bits a byte, lowest first; the eighth is set if more bytes follow."""
        value, shift = 0, 0
        while True:
            byte = self.byte()
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                return value
            shift += 7
            if shift > 63:
                raise ValueError("a number without end")

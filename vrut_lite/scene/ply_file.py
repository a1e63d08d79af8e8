"""Reads PLY, text or binary: any elements and properties (G. Turk, "The PLY Polygon File Format").

A mesh takes positions, normals, texture coordinates and colours from vertices, polygons from faces
or triangle strips, and colours and texture coordinates of faces. Everything else is passed over.
"""

import warnings
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.ear_clipping import polygon_corners
from vrut_lite.scene.mesh_file import FileMaterial, MeshFile, MeshPart
from vrut_lite.scene.process_limits import Damaged

_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
# Names that writers use: the format fixes none of them.
_CORNERS = ("vertex_indices", "vertex_index")
_COLOURS = (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"))
_VERTEX_UV = (("texture_u", "texture_v"), ("u", "v"), ("s", "t"))
_FACE_UV = ("texcoord", "texcoords")


class _Property(NamedTuple):
    """A property of an element; `size_kind` is the type of a list's size, else empty."""

    name: str
    kind: str
    size_kind: str


class _Element(NamedTuple):
    name: str
    rows: int
    properties: list[_Property]


class _List(NamedTuple):
    """A property of lists: how long each row's list is, and all values one after another."""

    sizes: NDArray[np.int64]
    values: NDArray[Any]


class _Columns(NamedTuple):
    """An element's properties by name."""

    scalars: dict[str, NDArray[Any]]
    lists: dict[str, _List]

    def together(self, *choices: tuple[str, ...]) -> NDArray[Any] | None:
        """The first choice of scalars that it has, as columns (rows, n); None without any."""
        for names in choices:
            if all(name in self.scalars for name in names):
                return np.stack([self.scalars[name] for name in names], axis=1)
        return None

    def first_list(self, names: tuple[str, ...]) -> _List | None:
        """The first list that it has of these names."""
        return next((self.lists[name] for name in names if name in self.lists), None)


class _Body(Protocol):
    """The part of a file after its head; places in it are counted in its own units."""

    units: int

    def width(self, kind: str) -> int:
        """Units of a value."""

    def size_at(self, kind: str, place: int) -> int:
        """A list's size."""

    def view(
        self, kind: str, place: int, shape: tuple[int, ...], steps: tuple[int, ...]
    ) -> NDArray[Any]:
        """Values at regular places, each axis `steps` units apart."""

    def gather(self, kind: str, places: NDArray[np.int64]) -> NDArray[Any]:
        """Values at any places."""


class _Text:
    """Numbers separated by white space; a unit is one of them."""

    def __init__(self, text: bytes) -> None:
        with warnings.catch_warnings():
            # It stops at the first word that is no number: then rows are missing.
            warnings.simplefilter("ignore", DeprecationWarning)
            self._numbers = np.fromstring(text, np.float64, sep=" ")
        self.units = len(self._numbers)

    def width(self, _kind: str) -> int:
        return 1

    def size_at(self, _kind: str, place: int) -> int:
        return int(self._numbers[place])

    def view(
        self, kind: str, place: int, shape: tuple[int, ...], steps: tuple[int, ...]
    ) -> NDArray[Any]:
        strides = tuple(8 * step for step in steps)
        numbers = np.ndarray(shape, np.float64, self._numbers, 8 * place, strides)
        return _as_kind(numbers, kind)

    def gather(self, kind: str, places: NDArray[np.int64]) -> NDArray[Any]:
        return _as_kind(self._numbers[places], kind)


def _as_kind(numbers: FloatArray, kind: str) -> NDArray[Any]:
    with np.errstate(invalid="ignore"):
        return numbers.astype(_TYPES[kind])


class _Binary:
    """Values without gaps; a unit is a byte."""

    def __init__(self, data: bytes, order: str) -> None:
        self._data, self._bytes, self._order = data, np.frombuffer(data, np.uint8), order
        self.units = len(data)

    def _type(self, kind: str) -> np.dtype[Any]:
        return np.dtype(self._order + _TYPES[kind])

    def width(self, kind: str) -> int:
        return self._type(kind).itemsize

    def size_at(self, kind: str, place: int) -> int:
        return int(np.frombuffer(self._data, self._type(kind), 1, place)[0])

    def view(
        self, kind: str, place: int, shape: tuple[int, ...], steps: tuple[int, ...]
    ) -> NDArray[Any]:
        return np.ndarray(shape, self._type(kind), self._data, place, steps)

    def gather(self, kind: str, places: NDArray[np.int64]) -> NDArray[Any]:
        width = self.width(kind)
        picked = self._bytes[places[:, None] + np.arange(width)]
        return np.ascontiguousarray(picked).view(self._type(kind))[:, 0]


def read_ply(data: bytes) -> MeshFile:
    """The file's mesh, in one part for each of its pictures.

    Raises:
        Damaged: it ends early, or its head or a face cannot be right.
    """
    elements, pictures, body = _split(data)
    columns: dict[str, _Columns] = {}
    place = 0
    for element in elements:
        columns[element.name], place = _read_element(body, element, place)
    nothing = _Columns({}, {})
    return _mesh_file(
        columns.get("vertex", nothing),
        columns.get("face", nothing),
        columns.get("tristrips", nothing),
        pictures,
    )


def _split(data: bytes) -> tuple[list[_Element], list[str], _Body]:
    """The head's elements and names of pictures, and the body."""
    head, mark, rest = data.partition(b"end_header")
    if data[:3] != b"ply" or not mark:
        raise Damaged("it does not begin with 'ply' and a head that ends in 'end_header'")
    # One end of a line: a byte of the body may look like another one.
    body = rest[2:] if rest.startswith(b"\r\n") else rest[1:]
    form, elements, pictures = "", [], []
    for line in head.decode("latin-1").splitlines():
        match line.split():
            case ["format", word, *_]:
                form = word
            case ["element", name, rows]:
                if not rows.isdecimal() or int(rows) > len(body):
                    counted = f"{int(rows):,}" if rows.isdecimal() else ascii(rows)
                    raise Damaged(
                        f"its head counts {counted} of the element {ascii(name)[1:-1]}, and "
                        f"{len(body):,} bytes follow"
                    )
                elements.append(_Element(name, int(rows), []))
            case ["property", "list", size_kind, kind, name] if elements:
                elements[-1].properties.append(_Property(name, kind, size_kind))
            case ["property", kind, name] if elements:
                elements[-1].properties.append(_Property(name, kind, ""))
            case ["comment", "TextureFile", *_]:
                pictures.append(line.split("TextureFile", 1)[1].strip())
    kinds = {
        kind for one in elements for p in one.properties for kind in (p.kind, p.size_kind or p.kind)
    }
    if unknown := kinds - set(_TYPES):
        raise Damaged(f"its head names the type {min(unknown)!a}")
    if form == "ascii":
        return elements, pictures, _Text(body)
    if form not in _ORDERS:
        raise Damaged(f"its format is {form!a}, neither ascii nor binary")
    return elements, pictures, _Binary(body, _ORDERS[form])


def _read_element(body: _Body, element: _Element, place: int) -> tuple[_Columns, int]:
    """The element's properties, and where they end."""
    found = _regular(body, element, place)
    return _irregular(body, element, place) if found is None else found


def _regular(body: _Body, element: _Element, place: int) -> tuple[_Columns, int] | None:
    """The element, if all its rows have lists of the same sizes; else None."""
    sizes: list[int] = []
    offsets: list[int] = []
    at = place
    for one in element.properties:
        size = 1
        if one.size_kind:
            if element.rows == 0 or at + body.width(one.size_kind) > body.units:
                return None
            size = body.size_at(one.size_kind, at)
            at += body.width(one.size_kind)
        sizes.append(size)
        offsets.append(at)
        at += size * body.width(one.kind)
    row = at - place
    end = place + element.rows * row
    if min(sizes, default=0) < 0 or end > body.units:
        return None
    columns = _Columns({}, {})
    for one, size, offset in zip(element.properties, sizes, offsets, strict=True):
        if one.size_kind:
            start = offset - body.width(one.size_kind)
            if (body.view(one.size_kind, start, (element.rows,), (row,)) != size).any():
                return None
            steps = (row, body.width(one.kind))
            values = body.view(one.kind, offset, (element.rows, size), steps)
            columns.lists[one.name] = _List(np.full(element.rows, size, np.int64), np.ravel(values))
        else:
            columns.scalars[one.name] = body.view(one.kind, offset, (element.rows,), (row,))
    return columns, end


def _irregular(body: _Body, element: _Element, place: int) -> tuple[_Columns, int]:
    """The element, row by row."""
    widths = [(body.width(p.size_kind or p.kind), body.width(p.kind)) for p in element.properties]
    starts = np.empty((len(widths), element.rows), np.int64)
    sizes = np.empty((len(widths), element.rows), np.int64)
    for row in range(element.rows):
        for number, one in enumerate(element.properties):
            first, width = widths[number]
            size = 1
            if one.size_kind:
                if place + first > body.units:
                    break
                size = body.size_at(one.size_kind, place)
                place += first
            starts[number, row], sizes[number, row] = place, size
            place += max(size, 0) * width
            if size < 0:
                raise Damaged(
                    f"a list of its element {ascii(element.name)[1:-1]} has {size} values"
                )
        else:
            if place <= body.units:
                continue
        raise Damaged(
            f"it ends before row {row + 1:,} of {element.rows:,} of its element "
            f"{ascii(element.name)[1:-1]}"
        )
    columns = _Columns({}, {})
    for number, one in enumerate(element.properties):
        if one.size_kind:
            each = np.repeat(starts[number], sizes[number])
            each += _within(sizes[number]) * widths[number][1]
            columns.lists[one.name] = _List(sizes[number], body.gather(one.kind, each))
        else:
            columns.scalars[one.name] = body.gather(one.kind, starts[number])
    return columns, place


def _within(sizes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Numbers 0, 1, ... within each of lists that follow one another."""
    return np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)


def _mesh_file(vertex: _Columns, face: _Columns, strips: _Columns, pictures: list[str]) -> MeshFile:
    points = vertex.together(("x", "y", "z"))
    if points is None:
        raise Damaged("its vertices have no x, y and z")
    points = points.astype(np.float64)
    polygons, strip = face.first_list(_CORNERS), strips.first_list(_CORNERS)
    file = MeshFile()
    if polygons is None and strip is not None:
        triangles = _strip_triangles(strip)
        if len(triangles) and not (triangles.min() >= 0 and triangles.max() < len(points)):
            raise Damaged(f"a strip names vertex {triangles.max():,} of {len(points):,}")
        file.parts.append(_part(vertex, points, triangles))
    elif polygons is not None:
        file.parts += _parts_of_faces(vertex, points, face, polygons, pictures, file)
    return file


def _parts_of_faces(
    vertex: _Columns,
    points: FloatArray,
    face: _Columns,
    polygons: _List,
    pictures: list[str],
    file: MeshFile,
) -> list[MeshPart]:
    """Polygons as triangles with what their corners have, a part for each picture."""
    indices = polygons.values.astype(np.int64)
    corners, polygon = polygon_corners(points, polygons.sizes, indices)
    triangles = indices[corners]
    vertex_uv, corner_uv = vertex.together(*_VERTEX_UV), face.first_list(_FACE_UV)
    rgb, face_rgb = vertex.together(*_COLOURS), face.together(*_COLOURS)
    uv = None
    if corner_uv is not None and (corner_uv.sizes == 2 * polygons.sizes).all():
        uv = corner_uv.values.astype(np.float64).reshape(-1, 2)[corners]
    elif vertex_uv is not None:
        uv = vertex_uv.astype(np.float64)[triangles]
    if uv is None or not pictures:
        corner_rgb = None if rgb is not None or face_rgb is None else _bytes_of(face_rgb)[polygon]
        return [_part(vertex, points, triangles, uv, corner_rgb)]
    if rgb is not None or face_rgb is not None:
        # MeshLab's are the picture's own, once more.
        file.left_out.append("colours of the PLY beside its picture")
    number = face.scalars.get("texnumber", np.zeros(len(polygons.sizes)))[polygon].astype(np.int64)
    parts = []
    for picture in np.unique(number):
        name = pictures[picture] if 0 <= picture < len(pictures) else ""
        chosen = number == picture
        white = np.full((int(chosen.sum()), 3), 255, np.uint8)
        part = _part(vertex, points, triangles[chosen], uv[chosen], None if name else white)
        if name:
            part.colours = b""
            part.material = FileMaterial("picture", (1.0,) * 4, 1.0, (0.0,) * 3, name)
        parts.append(part)
    return parts


def _part(
    vertex: _Columns,
    points: FloatArray,
    triangles: NDArray[np.int64],
    uv: FloatArray | None = None,
    triangle_rgb: NDArray[np.uint8] | None = None,
) -> MeshPart:
    """A part of triangles (F, 3); `uv` (F, 3, 2) is of their corners, `triangle_rgb` (F, 3)."""
    normals, rgb = vertex.together(("nx", "ny", "nz")), vertex.together(*_COLOURS)
    colours = np.empty(0, np.uint8) if rgb is None else _bytes_of(rgb)
    of_vertices = np.empty(0) if normals is None else normals.astype(np.float64)
    if uv is not None or triangle_rgb is not None:
        # Each corner becomes a vertex.
        each = triangles.reshape(-1)
        points, triangles = points[each], np.arange(len(each))
        of_vertices = of_vertices[each] if len(of_vertices) else of_vertices
        colours = colours[each] if len(colours) else colours
        if triangle_rgb is not None:
            colours = np.repeat(triangle_rgb, 3, axis=0)
    return MeshPart(
        "mesh",
        points.tobytes(),
        triangles.tobytes(),
        of_vertices.tobytes(),
        b"" if uv is None else uv.tobytes(),
        colours.tobytes(),
        np.eye(4)[None].tobytes(),
        None,
    )


def _bytes_of(rgb: NDArray[Any]) -> NDArray[np.uint8]:
    """Colours (n, 3) as bytes; floats are parts of 1, two bytes parts of 65,535."""
    numbers = np.nan_to_num(rgb.astype(np.float64))
    if rgb.dtype.kind == "f" and numbers.max(initial=0.0) <= 1.0:
        numbers = numbers * 255.0
    elif rgb.dtype.itemsize == 2:
        numbers = numbers / 257.0
    return np.clip(np.rint(numbers), 0, 255).astype(np.uint8)


def _strip_triangles(strip: _List) -> NDArray[np.int64]:
    """Triangles (F, 3) of strips, which -1 ends; each other triangle turns the other way."""
    index = np.append(strip.values.astype(np.int64), -1)
    ends = np.flatnonzero(index < 0)
    sizes = np.diff(ends, prepend=-1) - 1
    starts, counts = ends - sizes, np.maximum(sizes - 2, 0)
    within = _within(counts)
    first = np.repeat(starts, counts) + within
    triangles = np.stack([index[first], index[first + 1], index[first + 2]], axis=1)
    turned = within % 2 == 1
    triangles[turned] = triangles[turned][:, [1, 0, 2]]
    return triangles

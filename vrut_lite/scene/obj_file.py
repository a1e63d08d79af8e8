"""Reads OBJ text into arrays, block by block, in linear time."""

import re
import warnings
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.ear_clipping import ear_clipped
from vrut_lite.scene.obj_kernels import read_plain_block
from vrut_lite.scene.obj_strokes import ObjStrokes, StatedStrokes
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.text_files import decoded, plain_text

_BLOCK_BYTES = 2**22
# A file up to here is read word by word, in 30 ms: the kernel takes 400 ms to load.
_SHORT_BYTES = 2**19
# Keeps the words of one line, as Python objects, within the memory that any scene may take.
_MOST_LINE_BYTES = 2**22
_KINDS = (b"v", b"vt", b"vn")
# Statements that draw something that is not drawn here.
_UNREAD = {word.encode(): word for word in ("curv", "curv2", "surf")}
_STROKES = (b"p", b"l")
_DIGITS = b"0123456789"
# Remarks behind numbers; in names, # is a letter.
_COMMENTS = re.compile(rb"^( *(?:v[tn]?|[flp]) [^#\n]*)#[^\n]*", re.MULTILINE)
# Numbers of a corner: of vertex, texture coordinates and normal, counted from 1; 0 if missing.
_CORNER = 3
# Numbers of a vertex with a colour.
_COLOURED = 6
_MOST_NUMBER = 2**31 - 2
_NAME_BYTES = 256


@dataclass(frozen=True)
class ObjFile:
    """The content of an OBJ file.

    positions (V, 3), colours (V, 3) or none, texture coordinates (T, 2), normals (N, 3);
    `corners` (F, 3, 3) are the triangles' corners, each with the numbers of its position, texture
    coordinates and normal, counted from 0, -1 if it has none; `group` (F,) is the number of each
    triangle's material in `materials`. `strokes` are its points and its lines. `unread` counts
    statements that draw something else; `lost_colours`: only some of the vertices have colours.
    """

    positions: NDArray[np.float64]
    colours: NDArray[np.float64] | None
    uv: NDArray[np.float64]
    normals: NDArray[np.float64]
    corners: NDArray[np.int32]
    group: NDArray[np.int32]
    materials: tuple[str | None, ...]
    libraries: tuple[str, ...]
    strokes: list[ObjStrokes]
    unread: dict[str, int]
    lost_colours: bool


@dataclass
class _Reading:
    """The content that has been read so far."""

    budget: SceneBudget
    counts: dict[bytes, int] = field(default_factory=lambda: dict.fromkeys(_KINDS, 0))
    numbers: dict[bytes, list[NDArray[np.float64]]] = field(
        default_factory=lambda: {kind: [] for kind in _KINDS}
    )
    corners: list[NDArray[np.int32]] = field(default_factory=list)
    groups: list[NDArray[np.int32]] = field(default_factory=list)
    materials: dict[str | None, int] = field(default_factory=lambda: {None: 0})
    group: int = 0
    libraries: list[bytes] = field(default_factory=list)
    unread: Counter[str] = field(default_factory=Counter)
    has_colours: bool = False
    strokes: StatedStrokes = field(init=False)

    def __post_init__(self) -> None:
        self.strokes = StatedStrokes(self.budget)

    def keep(self, values: NDArray[Any]) -> NDArray[Any]:
        """Counts an array that stays in memory."""
        self.budget.take(values.nbytes, "its text, as numbers,")
        return values

    def use_material(self, material: str) -> None:
        """Assigns the faces that follow to this material."""
        if material not in self.materials:
            self.budget.take(len(material) + _NAME_BYTES, "the names of its materials")
            self.materials[material] = len(self.materials)
        self.group = self.materials[material]


def parse_obj(data: bytes, budget: SceneBudget) -> ObjFile:
    """The arrays of an OBJ file; polygons become triangles.

    Raises:
        SceneFileError: for malformed numbers, indices out of range, lines that are too long, or
            data that exceed the budget.
    """
    reading = _Reading(budget)
    text = plain_text(data)
    if text is not data:
        budget.take(len(text), "its text in UTF-8")
    read_block = _read_words if len(text) <= _SHORT_BYTES else _read_block
    for block in _blocks(text):
        read_block(block, reading)
    positions = _joined(reading.numbers[b"v"], 3)
    coloured = bool(reading.numbers[b"v"]) and positions.shape[1] >= _COLOURED
    corners = np.concatenate([np.zeros((0, 3, _CORNER), np.int32), *reading.corners])
    continues = corners[:, 0, 0] < 0
    np.abs(corners, out=corners)
    most = int(corners[..., 0].max(initial=0))
    if most > len(positions):
        raise SceneFileError(
            f"a face refers to vertex {most}, and it has {len(positions)}; export it again"
        )
    corners -= 1
    corners = ear_clipped(corners, continues, lambda ring: positions[ring[..., 0], :3])
    return ObjFile(
        positions[:, :3],
        positions[:, 3:6] if coloured else None,
        _joined(reading.numbers[b"vt"], 2)[:, :2],
        _joined(reading.numbers[b"vn"], 3)[:, :3],
        corners,
        np.concatenate([np.zeros(0, np.int32), *reading.groups]),
        tuple(reading.materials),
        tuple(dict.fromkeys(map(decoded, reading.libraries))),
        reading.strokes.all(len(positions)),
        dict(reading.unread),
        reading.has_colours and not coloured,
    )


def _blocks(data: bytes) -> Iterator[bytes]:
    """Whole lines, some megabytes at a time; continued lines joined, tabs turned into spaces."""
    start = 0
    while start < len(data):
        end = start + _BLOCK_BYTES
        while True:
            end = data.find(b"\n", end) + 1 or len(data)
            if end - start > _BLOCK_BYTES + _MOST_LINE_BYTES:
                raise SceneFileError(
                    f"a line in it is longer than {_MOST_LINE_BYTES >> 20} MB; export it again"
                )
            continued = data[max(end - 2, start) : end].rstrip(b"\n").endswith(b"\\")
            if end == len(data) or not continued:
                break
        block = data[start:end].replace(b"\\\n", b" ").replace(b"\t", b" ")
        yield _COMMENTS.sub(rb"\1", block) if b"#" in block else block
        start = end


def _read_block(block: bytes, reading: _Reading) -> None:
    before = tuple(reading.counts[kind] for kind in _KINDS)
    plain = read_plain_block(block, (before[0], before[1], before[2]))
    others = [] if plain is None else plain.lines.tolist()
    # Negative indices need the number of vertices before their line.
    counts_back = any(
        block[start : start + 1] in _STROKES and b"-" in block[start:end]
        for start, end, _ in others
    )
    if plain is None or counts_back:
        _read_words(block, reading)
        return
    groups = np.empty(len(plain.corners), np.int32)
    done = 0
    for start, end, triangles in others:
        groups[done:triangles] = reading.group
        done = triangles
        kind, _, rest = block[start:end].strip().partition(b" ")
        _read_statement(kind, rest, reading, 0)
    groups[done:] = reading.group
    for kind, found in zip(_KINDS, plain.rows, strict=True):
        reading.counts[kind] += len(found)
        reading.has_colours |= kind == b"v" and found.shape[1] >= _COLOURED
        if len(found):
            reading.numbers[kind].append(reading.keep(found))
    if len(plain.corners):
        reading.corners.append(reading.keep(plain.corners))
        reading.groups.append(reading.keep(groups))


def _read_statement(kind: bytes, rest: bytes, reading: _Reading, vertices: int) -> None:
    """Record a material, the library, points and lines, or an unsupported statement.

    `vertices` is the number of vertices before it; only negative indices need it.
    """
    if kind == b"usemtl":
        reading.use_material(decoded(rest).strip())
    elif kind == b"mtllib" and rest.strip():
        reading.budget.take(len(rest) + _NAME_BYTES, "the names of its material libraries")
        reading.libraries.append(rest.strip().strip(b'"'))
    elif kind in _STROKES:
        reading.strokes.read(kind, rest, vertices, reading.group)
    elif kind in _UNREAD:
        reading.unread[_UNREAD[kind]] += 1


def _read_words(block: bytes, reading: _Reading) -> None:
    """Read a short or not plain block word by word; refuse damaged lines."""
    rows: dict[bytes, list[bytes]] = {kind: [] for kind in _KINDS}
    faces: list[bytes] = []
    groups: list[int] = []
    before = dict(reading.counts)
    for line in block.split(b"\n"):
        kind, _, rest = line.strip().partition(b" ")
        if kind == b"f":
            if b"-" in rest:
                counts = [before[name] + len(rows[name]) for name in _KINDS]
                rest = b" ".join(_absolute_corner(corner, counts) for corner in rest.split())
            faces.append(rest)
            groups.append(reading.group)
        elif kind in rows:
            rows[kind].append(rest)
        else:
            _read_statement(kind, rest, reading, before[b"v"] + len(rows[b"v"]))
    for kind, found in rows.items():
        reading.counts[kind] += len(found)
        if kind == b"v" and not reading.has_colours:
            reading.has_colours = any(len(row.split()) >= _COLOURED for row in found)
        if found:
            reading.numbers[kind].append(reading.keep(_numbers(found, 2 if kind == b"vt" else 3)))
    if faces:
        _read_faces(faces, np.array(groups, np.int32), reading)


def _numbers(rows: list[bytes], least: int) -> NDArray[np.float64]:
    """The numbers (n, columns) in rows of words; longer rows are cut to the shortest."""
    widths = {len(row.split()) for row in rows}
    columns = min(widths)
    if columns < least:
        raise _damaged("where numbers belong are too few of them")
    if len(widths) > 1:
        rows = [b" ".join(row.split()[:columns]) for row in rows]
    values = _parsed(b" ".join(rows), np.float64)
    if values is None or values.size != columns * len(rows):
        raise _damaged("where numbers belong stands something else")
    return values.reshape(-1, columns)


def _parsed(words: bytes, dtype: type) -> NDArray[Any] | None:
    """The numbers in a text, or None if there is anything else in it."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(words, dtype, sep=" ")
        except (DeprecationWarning, ValueError):
            return None


def _joined(parts: list[NDArray[np.float64]], columns: int) -> NDArray[np.float64]:
    """Joins blocks of rows, cut to the narrowest."""
    if not parts:
        return np.zeros((0, columns))
    width = min(part.shape[1] for part in parts)
    return np.concatenate([part[:, :width] for part in parts])


def _read_faces(rows: list[bytes], groups: NDArray[np.int32], reading: _Reading) -> None:
    """Parses rows of the same form, such as three corners of two numbers each, together."""
    forms: defaultdict[tuple[bytes, bool], list[int]] = defaultdict(list)
    rows = [b" ".join(row.split()) for row in rows]
    for number, row in enumerate(rows):
        forms[row.translate(None, _DIGITS), b"//" in row].append(number)
    triangles, faces = [], []
    for (form, gap), numbers in forms.items():
        if form.count(b" ") < 2:  # A point or a line.
            continue
        found = [rows[number] for number in numbers]
        polygons = _polygons_of_one_form(found, form.split(b" "), gap)
        if polygons is None:
            for number, row in zip(numbers, found, strict=True):
                triangles.append(_fans(_polygon_of_mixed_form(row)))
                faces.append(np.full(len(triangles[-1]), number))
        else:
            triangles.append(_fans(polygons))
            faces.append(np.repeat(numbers, polygons.shape[1] - 2))
    if faces:
        face = np.concatenate(faces)
        order = np.argsort(face, kind="stable")
        reading.corners.append(reading.keep(np.concatenate(triangles)[order]))
        reading.groups.append(reading.keep(groups[face[order]]))


def _polygons_of_one_form(
    rows: list[bytes], form: list[bytes], gap: bool
) -> NDArray[np.int32] | None:
    """Polygons (m, k, 3) of rows whose corners are all written alike, or None.

    `form` has the slashes of each corner; `gap` says that the texture coordinates between two
    slashes are left out.
    """
    columns = {b"": [0], b"/": [0, 1], b"//": [0, 2] if gap else [0, 1, 2]}.get(form[0])
    if columns is None or any(corner != form[0] for corner in form):
        return None
    numbers = _parsed(b" ".join(rows).replace(b"/", b" "), np.int64)
    if numbers is None or numbers.size != len(rows) * len(form) * len(columns):
        return None
    polygons = np.zeros((len(rows), len(form), _CORNER), np.int32)
    polygons[..., columns] = _checked(numbers).reshape(len(rows), len(form), len(columns))
    return _with_vertices(polygons)


def _polygon_of_mixed_form(row: bytes) -> NDArray[np.int32]:
    """A polygon (1, k, 3) whose corners are written in different forms."""
    corners = []
    for corner in row.split():
        words = [*corner.split(b"/"), b"", b""][:_CORNER]
        if not words[0] or not all(word.isdigit() or not word for word in words):
            raise _damaged("where numbers belong stands something else")
        corners.append([min(int(word or b"0"), _MOST_NUMBER + 1) for word in words])
    return _with_vertices(_checked(np.array([corners])).astype(np.int32))


def _checked(numbers: NDArray[np.int64]) -> NDArray[np.int64]:
    if numbers.max() > _MOST_NUMBER:
        raise _damaged(f"a face refers to number {numbers.max()}")
    return numbers


def _with_vertices(polygons: NDArray[np.int32]) -> NDArray[np.int32]:
    """The polygons, each corner of which must name a vertex."""
    if polygons[..., 0].min() < 1:
        raise SceneFileError("a face refers to vertex 0, and OBJ counts from 1; export it again")
    return polygons


def _fans(polygons: NDArray[np.int32]) -> NDArray[np.int32]:
    """Triangles (n, 3, 3) of polygons (m, k, 3), each about its first corner.

    In triangles after a polygon's first one the number of that corner's vertex is negative.
    """
    onward = np.arange(1, polygons.shape[1] - 1)
    fan = np.stack([np.zeros_like(onward), onward, onward + 1], axis=1)
    triangles = polygons[:, fan]
    triangles[:, 1:, 0, 0] *= -1
    return triangles.reshape(-1, 3, _CORNER)


def _absolute_corner(corner: bytes, counts: list[int]) -> bytes:
    """A corner with its indices relative to this line made absolute."""
    words = []
    for word, count in zip(corner.split(b"/"), counts, strict=False):
        if word.startswith(b"-") and word[1:].isdigit():
            absolute = count + 1 - int(word[1:])
            if absolute < 1:
                raise SceneFileError("a face counts back beyond the first vertex; export it again")
            word = b"%d" % absolute
        words.append(word)
    return b"/".join(words)


def _damaged(reason: str) -> SceneFileError:
    return SceneFileError(f"its OBJ text is damaged: {reason}; export it again")

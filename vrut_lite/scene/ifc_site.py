"""Place and true north of an IFC file, read from its text (ISO 10303-21) without a library.

IfcSite states latitude, longitude and elevation (IFC 4.3, 5.4.3.58), and the representation context
true north (8.19.3.11). They become the scene's place before its geometry is read.
"""

import math
import re
import zipfile
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

from vrut_lite.errors import UserError
from vrut_lite.messages.place import SetPlace
from vrut_lite.scene.file_checks import MAX_FILE_BYTES

SUFFIXES = (".ifc", ".ifczip")
# A text, a number or a word, or a sign of ISO 10303-21.
_TOKEN = re.compile(rb"\s*(?:/\*.*?\*/\s*)*('(?:[^']|'')*'|[(),;]|[^\s'(),;]+)", re.DOTALL)
_PREFIXES = {"MILLI": 1e-3, "CENTI": 1e-2, "DECI": 1e-1, "KILO": 1e3}
# Shares of a degree of degrees, minutes, seconds and millionths of a second.
_PARTS = (1.0, 1 / 60, 1 / 3600, 1 / 3.6e9)
_KIND = re.compile(
    rb"=\s*(IFC(?:SITE|GEOMETRICREPRESENTATIONCONTEXT|MAPCONVERSION|UNITASSIGNMENT))\s*(?=\()"
)
_DEEPEST = 32


def ifc_text(data: bytes, count: Callable[[int], None] = lambda size: None) -> bytes:
    """The text of an IFC file; of an IFC-ZIP, of its first `.ifc`, whose size `count` may refuse.

    Raises:
        ValueError: it is no ISO 10303-21 text, or a ZIP without one of at most `MAX_FILE_BYTES`.
    """
    if data[:2] == b"PK":
        try:
            archive = zipfile.ZipFile(BytesIO(data))
            inside = [one for one in archive.infolist() if one.filename.lower().endswith(".ifc")]
            if not inside:
                raise ValueError("its archive has no .ifc")
            if inside[0].file_size > MAX_FILE_BYTES:
                raise ValueError(f"its archive holds {inside[0].file_size:,} bytes")
            count(inside[0].file_size)
            with archive.open(inside[0]) as file:
                data = file.read(inside[0].file_size)
        except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, OSError) as fault:
            raise ValueError("its archive is damaged") from fault
    if not data.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"ISO-10303-21"):
        raise ValueError("it does not begin with ISO-10303-21")
    return data


def place_of_ifc(path: str | Path) -> SetPlace | None:
    """The place that an IFC file states; None without one, or for a file that cannot be read."""
    if Path(path).suffix.lower() not in SUFFIXES:
        return None
    try:
        if Path(path).stat().st_size > MAX_FILE_BYTES:
            return None
        return stated_place(ifc_text(Path(path).read_bytes()))
    except (OSError, ValueError):
        return None


def stated_place(text: bytes) -> SetPlace | None:
    """The place of the first site that has one, with the altitude of the file's height 0.

    The direction of true north is (0, 1) where it is not stated; then that of a map's grid holds.
    """
    step = _Step(text)
    for site in step.of_kind(b"IFCSITE"):
        try:
            latitude_deg, longitude_deg = _degrees(site[9]), _degrees(site[10])
            if latitude_deg is None or longitude_deg is None:
                continue
            elevation = site[11] if isinstance(site[11], float) else 0.0
            height = elevation - step.height_of(site[5])
            place = SetPlace(
                latitude_deg=latitude_deg,
                longitude_deg=longitude_deg,
                altitude_m=round(height * step.metres_per_unit(), 3),
                north_offset_rad=step.north_offset_rad(),
            )
            place.check()
        except (AttributeError, IndexError, TypeError, ValueError, UserError):
            continue
        return place
    return None


def _degrees(parts: Any) -> float | None:
    """Decimal degrees of a list of up to four whole numbers that share their sign."""
    if not isinstance(parts, list) or not 1 <= len(parts) <= 4:
        return None
    return sum(share * part for share, part in zip(_PARTS, parts, strict=False))


class _Step:
    """Instances of an ISO 10303-21 text that are asked for; their arguments as nested lists.

    A number is a float, a reference its number in a tuple, `$` and `*` None, all else bytes.
    """

    def __init__(self, text: bytes) -> None:
        self._text = text
        self._starts: dict[bytes, list[int]] = {}
        for found in _KIND.finditer(text):
            self._starts.setdefault(found[1], []).append(found.end())

    def of_kind(self, kind: bytes) -> Iterator[list[Any]]:
        """The arguments of each instance of a kind."""
        return map(self._arguments, self._starts.get(kind, ()))

    def instance(self, reference: Any) -> tuple[bytes, list[Any]]:
        """Kind and arguments of what a reference names; no arguments if it names nothing."""
        if not isinstance(reference, tuple):
            return b"", []
        found = re.search(rb"#%d\s*=\s*(\w+)\s*(?=\()" % reference[0], self._text)
        return (b"", []) if found is None else (found[1].upper(), self._arguments(found.end()))

    def height_of(self, placement: Any) -> float:
        """Height of a local placement in the file's unit; those it is relative to stand upright."""
        height = 0.0
        for _ in range(_DEEPEST):
            kind, local = self.instance(placement)
            if kind != b"IFCLOCALPLACEMENT" or len(local) < 2:
                break
            _, axes = self.instance(local[1])
            _, point = self.instance(axes[0] if axes else None)
            if point and isinstance(point[0], list) and len(point[0]) > 2:
                height += float(point[0][2])
            placement = local[0]
        return height

    def metres_per_unit(self) -> float:
        """The length of the project's unit."""
        for units, *_ in self.of_kind(b"IFCUNITASSIGNMENT"):
            for unit in units if isinstance(units, list) else ():
                if len(said := self.instance(unit)[1]) > 3 and said[1] == b".LENGTHUNIT.":
                    return self._metres(unit)
        return 1.0

    def _metres(self, unit: Any, deepest: int = 4) -> float:
        """The length of an IfcSIUnit, or of an IfcConversionBasedUnit, as the foot is."""
        kind, said = self.instance(unit)
        if kind == b"IFCSIUNIT" and len(said) > 2:
            return _PREFIXES.get((said[2] or b"").strip(b".").decode(), 1.0)
        if kind != b"IFCCONVERSIONBASEDUNIT" or len(said) < 4 or deepest == 0:
            return 1.0
        # IFCMEASUREWITHUNIT(IFCLENGTHMEASURE(0.3048), #5)
        _, measure = self.instance(said[3])
        return float(measure[1][0]) * self._metres(measure[2], deepest - 1)

    def north_offset_rad(self) -> float:
        """How far the file's +Y points clockwise of true north."""
        for context in self.of_kind(b"IFCGEOMETRICREPRESENTATIONCONTEXT"):
            _, direction = self.instance(context[5] if len(context) > 5 else None)
            if direction and isinstance(direction[0], list) and len(direction[0]) > 1:
                return _offset(direction[0][0], direction[0][1])
        for conversion in self.of_kind(b"IFCMAPCONVERSION"):
            east, north = (*conversion[5:7], None, None)[:2]
            if isinstance(east, float) and isinstance(north, float):
                return _offset(north, east)
        return 0.0

    def _arguments(self, start: int) -> list[Any]:
        """The arguments in the bracket that begins at `start`; an empty list if it never ends."""
        stack: list[list[Any]] = [[]]
        for token in _TOKEN.finditer(self._text, start):
            word = token[1]
            if word == b"(":
                stack.append([])
            elif word == b")" and len(stack) > 1:
                done = stack.pop()
                stack[-1].append(done)
                if len(stack) == 1:
                    return done
            elif word == b";" or len(stack) > _DEEPEST:
                break
            elif word != b",":
                stack[-1].append(_value(word))
        return []


def _offset(x: float, y: float) -> float:
    """The scene's north offset where true north is (x, y) in the file's plane."""
    if not (math.isfinite(x) and math.isfinite(y)) or x == y == 0.0:
        return 0.0
    return -math.atan2(x, y)


def _value(word: bytes) -> Any:
    if word in (b"$", b"*"):
        return None
    if word.startswith(b"#") and word[1:].isdigit():
        return (int(word[1:]),)
    try:
        return float(word)
    except ValueError:
        return word

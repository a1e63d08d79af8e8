"""Place and true north of an IFC file, read from its text (ISO 10303-21) without a library.

IfcSite states latitude, longitude and elevation (IFC 4.3, 5.4.3.58), and the representation context
true north (8.19.3.11); else IfcMapConversion states them in a map, IfcProjectedCRS (8.18.3), of
which UTM is read. They become the scene's place before its geometry is read.
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
from vrut_lite.scene.utm import MapPlace, place_of_utm

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
_MAP = b"IFCMAPCONVERSION"
_UTM = re.compile(rb"(?<![A-Z])UTM\D{0,12}?(\d{1,2})(?!\d) ?(?:(N|S)(?![A-Z]))?", re.IGNORECASE)
_ZONE = re.compile(rb"(\d{1,2}) ?(N|S)?", re.IGNORECASE)
_EPSG = re.compile(rb"EPSG\W{0,3}(\d{4,5})\b", re.IGNORECASE)
# EPSG's codes of UTM less the zone, in the south if true: WGS 84, ETRS89, NAD83, GDA94, GDA2020.
_UTM_CODES = {32600: False, 32700: True, 25800: False, 26900: False, 28300: True, 7800: True}


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
    """The place of the first site that has one, else of a map, with the altitude of height 0.

    The direction of true north is (0, 1) where it is not stated; then that of a map's grid holds.
    """
    step = _Step(text)
    for site in step.of_kind(b"IFCSITE"):
        place = _checked(_place_of_site, step, site)
        if place is not None:
            return place
    return next(
        filter(None, (_checked(_place_of_map, step, one) for one in step.of_kind(_MAP))), None
    )


def _checked(
    make: Callable[["_Step", list[Any]], SetPlace | None], step: "_Step", instance: list[Any]
) -> SetPlace | None:
    """The place of an instance, in bounds; None where it states none or is damaged."""
    try:
        place = make(step, instance)
        if place is not None:
            place.check()
    except (AttributeError, IndexError, TypeError, ValueError, OverflowError, UserError):
        return None
    return place


def _place_of_site(step: "_Step", site: list[Any]) -> SetPlace | None:
    latitude_deg, longitude_deg = _degrees(site[9]), _degrees(site[10])
    if latitude_deg is None or longitude_deg is None:
        return None
    elevation = site[11] if isinstance(site[11], float) else 0.0
    height = elevation - step.height_of(site[5])
    return SetPlace(
        latitude_deg=latitude_deg,
        longitude_deg=longitude_deg,
        altitude_m=round(height * step.metres_per_unit(), 3),
        north_offset_rad=step.north_offset_rad(),
    )


def _place_of_map(step: "_Step", conversion: list[Any]) -> SetPlace:
    on_map, metres = step.map_place(conversion)
    height = conversion[4] if isinstance(conversion[4], float) else 0.0
    return SetPlace(
        latitude_deg=on_map.latitude_deg,
        longitude_deg=on_map.longitude_deg,
        altitude_m=round(height * metres, 3),
        north_offset_rad=step.north_offset_rad(),
    )


def _utm_zone(system: list[Any]) -> tuple[int, bool]:
    """Zone of UTM, and whether it is of the south, of an IfcProjectedCRS; ValueError for others."""
    words = [word if isinstance(word, bytes) else b"" for word in system]
    code = next(filter(None, map(_EPSG.search, words)), None)
    number = 0 if code is None else int(code[1])
    if (first := number // 100 * 100) in _UTM_CODES:
        return number - first, _UTM_CODES[first]
    found = next(filter(None, map(_UTM.search, words)), None)
    if found is None and len(words) > 5 and words[4].strip(b"' ").upper() == b"UTM":
        # MapProjection 'UTM' beside MapZone '32N'.
        found = _ZONE.fullmatch(words[5].strip(b"' "))
    if found is None:
        raise ValueError("the map is no UTM")
    return int(found[1]), (found[2] or b"N").upper() == b"S"


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
        """Kind and arguments of the referenced instance; no arguments if it does not exist."""
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
        for conversion in self.of_kind(_MAP):
            east, north = (*conversion[5:7], None, None)[:2]
            if isinstance(east, float) and isinstance(north, float):
                return _offset(north, east) + self._convergence_rad(conversion)
        return 0.0

    def map_place(self, conversion: list[Any]) -> tuple[MapPlace, float]:
        """Where an IfcMapConversion has the origin, and the length of the map's unit (m).

        Some programs write metres though the project's unit, which holds without one of the map's,
        is another.

        Raises:
            ValueError: the map is no UTM, or the origin lies outside its zone.
        """
        _, system = self.instance(conversion[1])
        zone, south = _utm_zone(system)
        unit = system[6] if len(system) > 6 else None
        metres = self.metres_per_unit() if unit is None else self._metres(unit)
        easting, northing = conversion[2:4]
        try:
            return place_of_utm(easting * metres, northing * metres, zone, south), metres
        except ValueError:
            return place_of_utm(easting, northing, zone, south), 1.0

    def _convergence_rad(self, conversion: list[Any]) -> float:
        """How far the map's grid north points clockwise of true north; 0 where it is unknown."""
        try:
            return self.map_place(conversion)[0].convergence_rad
        except (IndexError, TypeError, ValueError):
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

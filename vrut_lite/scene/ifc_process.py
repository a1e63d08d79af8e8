"""Reads IFC with ifcopenshell, which knows no limit, in its own process.

`python -m vrut_lite.scene.ifc_process SUFFIX BYTES` reads a file from standard input, takes at most
so much memory, and writes a `MeshFile` to standard output. Openings are cut by ifcopenshell.
"""

import math
import re
from collections import Counter
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import srgb_decode
from vrut_lite.scene.ifc_panes import are_closed, pane_triangles
from vrut_lite.scene.mesh_file import FileMaterial, GlassKind, MeshFile, MeshPart
from vrut_lite.scene.process_limits import Damaged, run_reader

# Seconds of CPU for any file and for each of its bytes; 5e-7 to 4e-6 a byte were measured.
_SECONDS, _SECONDS_PER_BYTE = 120, 1e-4
# Booleans of convex bodies exactly, all else by Open CASCADE: four times as fast as it alone.
_KERNEL: Final = "hybrid-cgal-simple-opencascade"
# Schemas with their corrections, and how ifcopenshell names each.
_SCHEMAS = {"IFC2X3": "IFC2X3", "IFC4": "IFC4", "IFC4X3": "IFC4X3_ADD2"}
_SCHEMA = re.compile(rb"FILE_SCHEMA\s*\(\s*\(\s*'([^']*)'", re.IGNORECASE)
# Classes without a visible surface.
_NOT_DRAWN = ("IfcSpace", "IfcOpeningElement", "IfcVirtualElement", "IfcAnnotation", "IfcGrid")
_NAMES_OF_GLASS = re.compile(
    r"gla[sz]|verglas|scheib|verre|vitr|vidri|vidro|vetr|szyb|szk[lł]|skl[oe]|стекл|玻璃|ガラス",
    re.IGNORECASE,
)
# Least transparency of a style that is glass: below it lie rounding and nets.
_CLEAR = 0.05
# Transmittance of glass without a stated transparency, one pass; with both faces' reflection 0.8,
# that of clear double glazing.
_GLASS_RGBA = (0.87, 0.87, 0.87, 1.0)
_GREY = 0.5
# Distance (m) from the origin beyond which a file has coordinates of a map.
_FAR_M = 10_000.0


class _Style(NamedTuple):
    material: FileMaterial | None
    glass: bool


_PLAIN = _Style(None, False)


def read(suffix: str, data: bytes) -> MeshFile:
    """The content of a file."""
    import ifcopenshell
    import ifcopenshell.geom

    data = _checked(data)
    settings = ifcopenshell.geom.settings()
    settings.set("apply-default-materials", False)
    settings.set("no-normals", True)

    def shapes_of(model: Any) -> Any:
        # One thread: where memory ends, one of several may wait for another for ever.
        return ifcopenshell.geom.iterator(
            settings, model, 1, exclude=list(_NOT_DRAWN), geometry_library=_KERNEL
        )

    # Loads the kernels' libraries: where a file left no room for them it would be called damaged.
    shapes_of(ifcopenshell.file(schema="IFC4")).initialize()
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    model = ifcopenshell.file.from_string(text)
    del text
    shapes = shapes_of(model)
    reader = _Reader(model)
    if shapes.initialize():
        reader.add(shapes.get())
        while shapes.next():
            reader.add(shapes.get())
    return reader.file()


def _checked(data: bytes) -> bytes:
    """The text under a schema that ifcopenshell knows: it refuses IFC4X3 and IFC4_ADD2."""
    if b"END-ISO-10303-21" not in data[-4096:]:
        raise Damaged("its text ends without END-ISO-10303-21")
    found = _SCHEMA.search(data[:65536])
    if found is None:
        raise Damaged("its head names no FILE_SCHEMA")
    schema = found[1].decode("latin-1").upper()
    known = _SCHEMAS.get(schema.partition("_")[0])
    if known is None:
        raise Damaged(f"its schema is {schema[:40]}, and {', '.join(_SCHEMAS)} are read")
    return data[: found.start(1)] + known.encode() + data[found.end(1) :]


class _Reader:
    """Collects the shapes of a model; equal shapes of one kind are one mesh at several places."""

    def __init__(self, model: Any) -> None:
        self._model = model
        self._parts: dict[tuple[str, bool], list[MeshPart]] = {}
        self._places: dict[tuple[str, bool], tuple[list[bytes], list[str]]] = {}
        self._styles: dict[int, _Style] = {}
        self._counts: Counter[tuple[str, str]] = Counter()
        self._drawn: set[int] = set()
        self._parent = {
            child.id(): rel.RelatingObject
            for rel in model.by_type("IfcRelAggregates")
            for child in rel.RelatedObjects
        }
        self._storey = {
            child.id(): rel.RelatingStructure
            for rel in model.by_type("IfcRelContainedInSpatialStructure")
            for child in rel.RelatedElements
        }

    def add(self, shape: Any) -> None:
        """Add an element of the iterator."""
        element, geometry = self._model.by_id(shape.id), shape.geometry
        self._drawn.add(shape.id)
        is_window = self._is_window(element)
        key = (str(geometry.id), is_window)
        if key not in self._parts:
            self._parts[key] = self._meshes(element, geometry, is_window)
            self._places[key] = ([], [])
        matrix = np.frombuffer(shape.transformation_buffer, np.float64).reshape(4, 4)
        self._places[key][0].append(matrix.T.tobytes())
        self._places[key][1].append(self._name(element))

    def file(self) -> MeshFile:
        """The content, with counts of omissions and guesses."""
        parts = []
        for key, meshes in self._parts.items():
            places, names = self._places[key]
            for part in meshes:
                part.world_from_part, part.names = b"".join(places), names
                parts.append(part)
        told = [(what, instead, count) for (what, instead), count in self._counts.items()]
        missing = Counter(
            one.is_a() for one in self._model.by_type("IfcElement") if self._is_missing(one)
        )
        for kind, count in missing.items():
            told.append((f"{kind} without a shape that can be made", "left out", count))
        return MeshFile(parts=_near(parts, told), up="z", metres_per_unit=1.0, told=told)

    def _is_missing(self, element: Any) -> bool:
        """Whether it has a body and was not made."""
        shape = element.Representation
        if shape is None or element.id() in self._drawn or any(map(element.is_a, _NOT_DRAWN)):
            return False
        return any(one.RepresentationIdentifier == "Body" for one in shape.Representations)

    def _is_window(self, element: Any) -> bool:
        """Whether unstyled geometry may be a pane: of a window, or a plate of a curtain wall."""
        if element.is_a("IfcWindow"):
            return True
        if not element.is_a("IfcPlate"):
            return False
        parent = self._parent.get(element.id())
        in_wall = parent is not None and parent.is_a("IfcCurtainWall")
        return in_wall or getattr(element, "PredefinedType", None) == "CURTAIN_PANEL"

    def _name(self, element: Any) -> str:
        """`Storey/Name`; the storey is that of the element or of its whole."""
        at = element
        for _ in range(32):
            if at.id() in self._storey or at.id() not in self._parent:
                break
            at = self._parent[at.id()]
        storey = self._storey.get(at.id())
        own = element.Name or element.is_a()
        return own if storey is None else f"{storey.Name or storey.is_a()}/{own}"

    def _meshes(self, element: Any, geometry: Any, is_window: bool) -> list[MeshPart]:
        """A mesh for each style of a shape."""
        vertices = np.frombuffer(geometry.verts_buffer, np.float64).reshape(-1, 3)
        triangles = np.frombuffer(geometry.faces_buffer, np.int32).astype(np.int64).reshape(-1, 3)
        style_of = np.frombuffer(geometry.material_ids_buffer, np.int32)
        styles = [self._style(one) for one in geometry.materials]
        # Number -1 is that of no style.
        order = list(dict.fromkeys(styles))
        number = np.array([*map(order.index, styles), -1])[style_of]
        looks_glazed = any(style.glass for style in styles)
        parts = []
        for index in np.unique(number):
            style = _PLAIN if index < 0 else order[index]
            here = triangles[number == index]
            groups: list[tuple[NDArray[np.int64], FileMaterial | None]] = []
            if style.glass and style.material is not None:
                kind: GlassKind = "body" if are_closed(vertices, here) else "pane"
                groups.append((here, _glass_of(style.material, kind)))
                self._counts["transparent style", "glass of its colour"] += 1
            elif is_window and not looks_glazed:
                panes = pane_triangles(vertices, here)
                if panes.any():
                    kind = "body" if are_closed(vertices, here[panes]) else "pane"
                    glass = FileMaterial("glass", _GLASS_RGBA, 0.0, (0.0, 0.0, 0.0), "", kind)
                    groups.append((here[panes], glass))
                    self._counts["window without a transparent style",
                                 "its flat panes are clear double glazing"] += 1  # fmt: skip
                else:
                    self._counts["window without a pane", "opaque"] += 1
                groups.append((here[~panes], style.material))
            else:
                groups.append((here, style.material))
            parts += [
                _part(str(element.Name or element.is_a()), vertices, faces, material)
                for faces, material in groups
                if len(faces)
            ]
        return parts

    def _style(self, source: Any) -> _Style:
        number = source.instance_id()
        if number not in self._styles:
            self._styles[number] = self._converted(source, number)
        return self._styles[number]

    def _converted(self, source: Any, number: int) -> _Style:
        """A style with its colour from sRGB, as programs show it."""
        named = self._model.by_id(number) if number > 0 else None
        name = str(getattr(named, "Name", None) or source.name)
        rgb = source.diffuse.components if source.diffuse else (math.nan,) * 3
        if not all(map(math.isfinite, rgb)):
            return _PLAIN
        stated = source.transparency
        transparency = float(np.clip(stated, 0.0, 1.0)) if math.isfinite(stated) else 0.0
        linear = srgb_decode(np.clip(rgb, 0.0, 1.0))
        exponent = source.specularity
        shines = math.isfinite(exponent) and exponent > 0.0
        roughness = (2.0 / (exponent + 2.0)) ** 0.25 if shines else 1.0
        alpha = 1.0 - transparency
        rgba = (float(linear[0]), float(linear[1]), float(linear[2]), alpha)
        glass = transparency >= _CLEAR
        if not glass and _NAMES_OF_GLASS.search(name):
            # An opaque colour under a name of glass: as other glass that states nothing.
            glass, rgba = True, (1.0, 1.0, 1.0, 1.0 - _GLASS_RGBA[0])
        return _Style(FileMaterial(name, rgba, roughness, (0.0, 0.0, 0.0)), glass)


def _glass_of(material: FileMaterial, kind: GlassKind) -> FileMaterial:
    """Glass that leaves of white light what a program shows of white behind the style."""
    red, green, blue, alpha = material.colour_rgba
    left = [1.0 - alpha + alpha * one for one in (red, green, blue)]
    rgba = (left[0], left[1], left[2], 1.0)
    return FileMaterial(material.name, rgba, 0.0, (0.0, 0.0, 0.0), "", kind)


def _part(
    name: str,
    vertices: NDArray[np.float64],
    triangles: NDArray[np.int64],
    material: FileMaterial | None,
) -> MeshPart:
    used, triangles = np.unique(triangles, return_inverse=True)
    return MeshPart(
        name, vertices[used].tobytes(), triangles.astype(np.int64).tobytes(), b"", b"", b"", b"",
        material,
    )  # fmt: skip


def _near(parts: list[MeshPart], told: list[tuple[str, str, int]]) -> list[MeshPart]:
    """The meshes moved level to the origin where they lie at coordinates of a map.

    Vertices far from their own origin are given relative to their middle, for single precision.
    """
    lows, highs = [], []
    for part in parts:
        vertices = np.frombuffer(part.vertices, np.float64).reshape(-1, 3)
        places = np.frombuffer(part.world_from_part, np.float64).reshape(-1, 4, 4)
        middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
        if np.abs(middle).max() > _FAR_M:
            vertices, places = vertices - middle, places.copy()
            places[:, :3, 3] += places[:, :3, :3] @ middle
            part.vertices, part.world_from_part = vertices.tobytes(), places.tobytes()
        lows.append(places[:, :3, 3].min(axis=0))
        highs.append(places[:, :3, 3].max(axis=0))
    if not parts:
        return parts
    middle = np.round(0.5 * (np.min(lows, axis=0) + np.max(highs, axis=0)))
    middle[2] = 0.0
    if np.abs(middle).max() > _FAR_M:
        for part in parts:
            places = np.frombuffer(part.world_from_part, np.float64).reshape(-1, 4, 4).copy()
            places[:, :3, 3] -= middle
            part.world_from_part = places.tobytes()
        told.append((f"lies at {middle[0]:.0f}, {middle[1]:.0f} m of a map", "moved to 0, 0", 1))
    return parts


if __name__ == "__main__":
    run_reader(read, _SECONDS, _SECONDS_PER_BYTE)

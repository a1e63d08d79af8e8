"""Reads STL, 3MF and COLLADA with trimesh, which knows no limit, in its own process.

`python -m vrut_lite.scene.trimesh_process SUFFIX BYTES` reads a file from standard input, takes at
most so much memory, and writes a `MeshFile` to standard output.
"""

import re
import zipfile
from collections.abc import Callable, Iterator, Mapping
from io import BytesIO
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from vrut_lite.scene.mesh_file import FileMaterial, MeshFile, MeshPart
from vrut_lite.scene.placed import MAX_PLACES
from vrut_lite.scene.process_limits import Damaged, run_reader

# Seconds of CPU for any file and for each of its bytes; the slowest, 3MF, takes 6e-6 a byte.
_SECONDS, _SECONDS_PER_BYTE = 60, 2e-5
_UP_AXIS = re.compile(rb"<up_axis>\s*([XYZ])_UP")
_UNIT = re.compile(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']([^\"']+)")
# Metres in each unit of the 3MF core specification, section 3.4.
_UNITS_OF_3MF = {
    "micron": 1e-6,
    "centimeter": 0.01,
    "inch": 0.0254,
    "foot": 0.3048,
    "meter": 1.0,
}
# Most levels of components in components of a 3MF.
_DEEPEST = 100
_LEFT_OUT = {
    b"<instance_camera": "camera of the COLLADA",
    b"<instance_light": "lamp of the COLLADA",
    b"<instance_controller": "skinned mesh of the COLLADA",
    b"<library_animations": "animations of the COLLADA",
}


class _PictureNames(Mapping[str, bytes]):
    """Answers each picture's name with a picture of one pixel that carries it.

    The pictures themselves are read elsewhere, where their sizes are counted.
    """

    def __getitem__(self, key: str) -> bytes:
        named, data = PngInfo(), BytesIO()
        named.add_text("name", key)
        Image.new("RGB", (1, 1)).save(data, "PNG", pnginfo=named)
        return data.getvalue()

    def __iter__(self) -> Iterator[str]:
        return iter(())

    def __len__(self) -> int:
        return 0


def read(suffix: str, data: bytes) -> MeshFile:
    """The content of a file with this suffix."""
    data, pictures = _CHECKS.get(suffix, bytes)(data), _PictureNames()
    scene = trimesh.load_scene(
        BytesIO(data), file_type=suffix[1:], resolver=pictures, process=False
    )
    file = MeshFile()
    colours = _colours_of_3mf(data, file) if suffix == ".3mf" else []
    for number, (name, geometry) in enumerate(scene.geometry.items()):
        if isinstance(geometry, trimesh.Trimesh):
            nodes = scene.graph.geometry_nodes.get(name, [])
            places = np.array([scene.graph[node][0] for node in nodes], np.float64)
            corner_rgb = colours[number] if number < len(colours) else None
            file.parts.append(_part(name, geometry, places, corner_rgb))
    _add_statements(file, suffix, data, scene)
    return file


def _part(
    name: str, mesh: Any, places: NDArray[np.float64], corner_rgb: NDArray[np.uint8] | None
) -> MeshPart:
    vertices, triangles, visual = mesh.vertices, mesh.faces, mesh.visual
    normals = mesh.vertex_normals if "vertex_normals" in mesh._cache.cache else np.empty(0)
    uv, colours, material = np.empty(0), np.empty(0, np.uint8), None
    if visual.kind == "texture":
        material = _material(visual.material)
        uv = np.empty(0) if visual.uv is None else visual.uv
        stated = mesh.vertex_attributes.get("color")
        if stated is not None:
            colours = trimesh.visual.to_rgba(stated)[:, :3]
    elif visual.kind == "vertex":
        colours = visual.vertex_colors[:, :3]
    elif visual.kind == "face":
        corner_rgb = np.repeat(visual.face_colors[:, None, :3], 3, axis=1)
    if corner_rgb is not None and len(corner_rgb) == len(triangles):
        # Colours of corners: each corner becomes a vertex.
        vertices, normals = vertices[triangles.reshape(-1)], np.empty(0)
        triangles = np.arange(triangles.size)
        colours = corner_rgb
    return MeshPart(
        name,
        np.asarray(vertices, np.float64).tobytes(),
        np.asarray(triangles, np.int64).tobytes(),
        np.asarray(normals, np.float64).tobytes(),
        np.asarray(uv, np.float64).tobytes(),
        np.asarray(colours, np.uint8).tobytes(),
        places.tobytes(),
        material,
    )


def _material(source: Any) -> FileMaterial | None:
    if not isinstance(source, trimesh.visual.material.PBRMaterial):
        return None
    rgba = [1.0] * 4 if source.baseColorFactor is None else list(source.baseColorFactor / 255.0)
    emission = [0.0] * 3 if source.emissiveFactor is None else list(source.emissiveFactor)
    return FileMaterial(
        str(source.name or ""),
        (float(rgba[0]), float(rgba[1]), float(rgba[2]), float(rgba[3])),
        1.0 if source.roughnessFactor is None else float(source.roughnessFactor),
        (float(emission[0]), float(emission[1]), float(emission[2])),
        getattr(source.baseColorTexture, "info", {}).get("name", ""),
    )


def _add_statements(file: MeshFile, suffix: str, data: bytes, scene: Any) -> None:
    """Add the file's axes and units, and the names of parts that are left out."""
    if suffix == ".3mf":
        # Its build platform is the plane of x and y.
        unit = next((g.metadata.get("units") for g in scene.geometry.values()), None)
        missing = _places_of_3mf(_model_of_3mf(data)) - len(scene.graph.nodes_geometry)
        if missing > 0:
            file.told.append(("place of a 3MF's component", "left out", missing))
        file.up, file.metres_per_unit = "z", _UNITS_OF_3MF.get(str(unit), 0.001)
    elif suffix == ".dae":
        # Also of UTF-16.
        data = data.replace(b"\0", b"")
        up, unit = _UP_AXIS.search(data), _UNIT.search(data)
        file.up = "y" if up is None else up[1].decode().lower()
        file.metres_per_unit = 1.0 if unit is None else float(unit[1].replace(b",", b"."))
        file.left_out += [name for tag, name in _LEFT_OUT.items() if tag in data]
    elif suffix == ".stl" and any(
        np.any(g.face_attributes.get("stl", 0)) for g in scene.geometry.values()
    ):
        file.left_out.append("colours of the STL")


def _model_of_3mf(data: bytes) -> Any:
    """The root of the archive's model."""
    from lxml import etree

    archive = zipfile.ZipFile(BytesIO(data))
    name = next(name for name in archive.namelist() if "3d/3dmodel.model" in name.lower())
    return etree.fromstring(archive.read(name), etree.XMLParser(resolve_entities=False))


def _colours_of_3mf(data: bytes, file: MeshFile) -> list[NDArray[np.uint8] | None]:
    """Colours (F, 3, 3) of the corners of each mesh's triangles, which trimesh leaves out.

    3MF core specification 1.3, section 5 (base materials), and materials extension 1.2, section 3
    (colour groups).
    """
    root = _model_of_3mf(data)
    groups: dict[str, NDArray[np.uint8]] = {}
    for kind, item, key in (
        ("basematerials", "base", "displaycolor"),
        ("colorgroup", "color", "color"),
    ):
        for group in root.iter("{*}" + kind):
            texts = [one.get(key, "#FFFFFF")[1:7] for one in group.iter("{*}" + item)]
            groups[group.get("id")] = np.array([list(bytes.fromhex(t)) for t in texts], np.uint8)
    if next(root.iter("{*}texture2dgroup"), None) is not None:
        file.left_out.append("textures of the 3MF")
    found: list[NDArray[np.uint8] | None] = []
    for one in root.iter("{*}object"):
        triangles = [t for mesh in one.iter("{*}mesh") for t in mesh.iter("{*}triangle")]
        if next(one.iter("{*}mesh"), None) is not None:
            found.append(_colours_of_object(one, triangles, groups))
    return found


def _colours_of_object(
    source: Any, triangles: list[Any], groups: dict[str, NDArray[np.uint8]]
) -> NDArray[np.uint8] | None:
    """Colours (F, 3, 3) of an object's triangles; None without any."""
    own = source.get("pid"), source.get("pindex", "0")
    if not any(one.get("pid", own[0]) in groups for one in triangles):
        return None
    rgb = np.full((len(triangles), 3, 3), 188, np.uint8)
    for number, one in enumerate(triangles):
        group = groups.get(one.get("pid", own[0]))
        if group is not None:
            first = one.get("p1", own[1])
            at = [int(one.get(key, first)) for key in ("p1", "p2", "p3")]
            rgb[number] = group[at]
    return rgb


def _checked_stl(data: bytes) -> bytes:
    """The file without what follows its triangles."""
    if data[:512].lstrip()[:5].lower() == b"solid" and b"facet" in data[:4096].lower():
        if b"endsolid" not in data.lower():
            raise Damaged("its text ends without 'endsolid'")
        return data
    if len(data) < 84:
        raise Damaged(f"it has {len(data)} bytes, fewer than the head of an STL")
    count = int.from_bytes(data[80:84], "little")
    size = 84 + 50 * count
    if size > len(data):
        raise Damaged(f"its head counts {count:,} triangles, and it has {len(data):,} bytes")
    return data[:size]


def _checked_3mf(data: bytes) -> bytes:
    if not zipfile.is_zipfile(BytesIO(data)):
        raise Damaged("it is no ZIP archive, or lacks its end")
    names = zipfile.ZipFile(BytesIO(data)).namelist()
    if not any("3d/3dmodel.model" in name.lower() for name in names):
        raise Damaged("its archive has no 3D/3dmodel.model")
    if (places := _places_of_3mf(_model_of_3mf(data))) > MAX_PLACES:
        raise Damaged(f"it places {places:,} meshes, above the limit of {MAX_PLACES:,}")
    return data


def _places_of_3mf(root: Any) -> int:
    """How many meshes its build places, those of components of components too."""
    parts = {
        one.get("id"): (
            sum(1 for _ in one.iterfind("{*}mesh")),
            [part.get("objectid") for part in one.iterfind("{*}components/{*}component")],
        )
        for one in root.iter("{*}object")
    }
    found: dict[str, int] = {}

    def count(name: str, above: frozenset[str]) -> int:
        if name in above or len(above) > _DEEPEST:
            raise Damaged("its components contain themselves, or are too deep")
        if name not in found:
            meshes, components = parts.get(name, (0, []))
            found[name] = meshes + sum(count(one, above | {name}) for one in components)
        return found[name]

    return sum(count(item.get("objectid"), frozenset()) for item in root.iter("{*}item"))


_CHECKS: dict[str, Callable[[bytes], bytes]] = {
    ".stl": _checked_stl,
    ".3mf": _checked_3mf,
}


if __name__ == "__main__":
    run_reader(read, _SECONDS, _SECONDS_PER_BYTE)

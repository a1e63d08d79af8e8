"""STL, PLY, OFF, 3MF and COLLADA as placed meshes, through trimesh.

trimesh runs in a process of its own under the scene's memory limit. Colours of vertices and faces
are sRGB, as programs show them; those of COLLADA's materials are linear, as an MTL's Kd.
"""

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import unquote

import msgspec
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.geometry.colour import srgb_decode
from vrut_lite.memory_limit import VARIABLE
from vrut_lite.messages.placement import (
    LEAST_METRES_PER_UNIT,
    MOST_METRES_PER_UNIT,
    Placement,
    UpAxis,
)
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.file_checks import SceneFolder
from vrut_lite.scene.images import PixelBudget, decode_image
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.materials import TOLD_GREY, SurfaceMaterial, default_material
from vrut_lite.scene.mesh import (
    MESH_BYTES,
    geometry_bytes,
    make_geometry,
    make_mesh,
    used_vertices,
)
from vrut_lite.scene.mesh_file import FileMaterial, MeshFile, MeshPart
from vrut_lite.scene.mtl_file import portable_name
from vrut_lite.scene.placed import PlacedMesh, check_places, check_triangles
from vrut_lite.scene.scene_file_error import SceneFileError, UnreadFile

SUFFIXES = (".stl", ".ply", ".off", ".3mf", ".dae")
_NAMES = {".stl": "STL", ".ply": "PLY", ".off": "OFF", ".3mf": "3MF", ".dae": "COLLADA"}
# Address space of Python, numpy and trimesh before they read (281 MiB measured).
_LIBRARY_BYTES = 2**29


def read_trimesh_scene(
    path: Path, budget: SceneBudget, notices: Notices
) -> tuple[list[PlacedMesh], Placement]:
    """Meshes in the file's axes and units, and what it states of these.

    Raises:
        SceneFileError: a package is missing, or the file is damaged or does not fit the budget.
    """
    folder = SceneFolder(path.parent, budget)
    file = _read_apart(path.suffix.lower(), folder.read(path), budget)
    for name in file.left_out:
        notices.tell(name, "left out")
    makers = _Makers(folder, notices)
    placed: list[PlacedMesh] = []
    triangles = 0
    for part in file.parts:
        triangles += len(part.triangles) // 24
        check_triangles(triangles)
        placed += makers.places(part)
        check_places(len(placed))
    if file.up == "x":
        notices.tell("up axis X", "taken to stand along +Y (else --up z)")
    unit = file.metres_per_unit
    if unit is not None:
        unit = float(np.clip(unit, LEAST_METRES_PER_UNIT, MOST_METRES_PER_UNIT))
    ups: dict[str, UpAxis] = {"x": "y", "y": "y", "z": "z"}
    return placed, Placement(up=ups.get(file.up), metres_per_unit=unit)


def _read_apart(suffix: str, data: bytes, budget: SceneBudget) -> MeshFile:
    """The content of a file, read by another process."""
    kind, room_bytes = _NAMES[suffix], budget.room_bytes
    command = [sys.executable, "-m", "vrut_lite.scene.trimesh_process", suffix]
    with tempfile.TemporaryFile() as answer:
        done = subprocess.run(
            [*command, str(int(room_bytes) + _LIBRARY_BYTES)],
            input=data,
            stdout=answer,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
            check=False,
        )
        size = answer.seek(0, os.SEEK_END)
        if done.returncode == -signal.SIGXCPU or done.returncode == -signal.SIGKILL:
            raise SceneFileError(f"its {kind} takes too long to read; simplify it")
        if done.returncode != 0 or size == 0:
            raise SceneFileError(f"its {kind} ends the program that reads it; export it again")
        budget.take(size, f"the content of the {kind}")
        answer.seek(0)
        file = msgspec.msgpack.decode(answer.read(), type=MeshFile)
    if file.lacks_memory:
        raise SceneFileError(
            f"its {kind} takes more than {room_bytes / 2**30:.1f} GiB to read, which is left of "
            f"the limit; simplify it, or raise {VARIABLE}"
        )
    if file.lacks_library:
        raise SceneFileError(
            f"it is {kind}, and a Python package to read it is missing: "
            "`pip install 'vrut-lite[formats]'`, or import it into Blender and export it as glTF"
        )
    if file.fault:
        raise SceneFileError(f"its {kind} is damaged ({ascii(file.fault)[1:-1]}); export it again")
    return file


class _Makers:
    """Makes the meshes of one file, and each of its pictures once."""

    def __init__(self, folder: SceneFolder, notices: Notices) -> None:
        self._folder, self._notices = folder, notices
        self._pixels = PixelBudget(folder.budget)
        self._pictures: dict[str, Image.Image | None] = {}

    def places(self, part: MeshPart) -> list[PlacedMesh]:
        """A mesh at its places; they share it."""
        vertices, triangles = _rows(part.vertices, 3), _whole(part.triangles)
        if not len(triangles):
            return []
        name, budget = part.name, self._folder.budget
        normals = _rows(part.normals, 3) if part.normals else None
        uv = _rows(part.uv, 2) if part.uv else None
        size = geometry_bytes(len(vertices), len(triangles), normals=normals is not None, layers=2)
        budget.take(size + MESH_BYTES, f"mesh {ascii(name)[:60]}")
        arrays = {"POSITION": vertices}
        if normals is not None:
            arrays["NORMAL"] = normals
        if uv is not None:
            arrays["uv"] = uv
        if part.colours:
            rgb = np.frombuffer(part.colours, np.uint8).reshape(-1, 3)
            arrays["COLOR"] = srgb_decode(rgb / 255.0)
        triangles, arrays = used_vertices(name, triangles, arrays)
        geometry = make_geometry(
            name,
            arrays["POSITION"],
            triangles,
            budget,
            normals=arrays.get("NORMAL"),
            uv=arrays.get("uv"),
            colours=arrays.get("COLOR"),
        )
        mesh = make_mesh(geometry, self._material(part.material, coloured=bool(part.colours)))
        return [PlacedMesh(name, mesh, place) for place in _rows(part.world_from_part, 16)]

    def _material(self, source: FileMaterial | None, coloured: bool) -> SurfaceMaterial:
        """A double-sided material: none of these formats has back faces."""
        if source is None:
            if not coloured:
                self._notices.tell_once("mesh without colours", TOLD_GREY)
            material = default_material(coloured)
            material.doubleSided = True
            return material
        picture = self._picture(source.picture) if source.picture else None
        alpha = source.colour_rgba[3]
        cut_out = picture is not None and picture.mode == "RGBA"
        return SurfaceMaterial(
            name=source.name,
            baseColorFactor=np.array(source.colour_rgba),
            baseColorTexture=picture,
            metallicFactor=0.0,
            roughnessFactor=source.roughness,
            emissiveFactor=np.maximum(source.emission_rgb, 0.0),
            alphaMode="BLEND" if alpha < 1.0 else "MASK" if cut_out else "OPAQUE",
            doubleSided=True,
        )

    def _picture(self, uri: str) -> Image.Image | None:
        """The decoded picture; None, with a warning, if it is missing or outside the folder."""
        if uri not in self._pictures:
            name = portable_name(unquote(uri.removeprefix("file://")), self._folder)
            try:
                data = self._folder.get(name)
            except UnreadFile as fault:
                self._notices.tell(f"picture {name}", f"{fault.why}, left out")
                self._pictures[uri] = None
            else:
                self._pixels.admit(data, ascii(name))
                self._pictures[uri] = decode_image(data, ascii(name))
        return self._pictures[uri]


def _rows(data: bytes, columns: int) -> NDArray[np.float64]:
    """Numbers as rows (n, columns), and matrices (n, 4, 4) for 16."""
    rows = np.frombuffer(data, np.float64)
    return rows.reshape(-1, 4, 4) if columns == 16 else rows.reshape(-1, columns)


def _whole(data: bytes) -> NDArray[np.int64]:
    return np.frombuffer(data, np.int64).reshape(-1, 3)

"""Placed meshes of a file that another process has read, and its materials and pictures."""

from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.geometry.colour import srgb_decode
from vrut_lite.messages.surface_terms import SurfaceTerms
from vrut_lite.scene.file_checks import SceneFolder
from vrut_lite.scene.images import PixelBudget, decode_image
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.materials import TOLD_GREY, SurfaceMaterial, default_material
from vrut_lite.scene.mesh import MESH_BYTES, geometry_bytes, make_geometry, make_mesh, used_vertices
from vrut_lite.scene.mesh_file import FileMaterial, MeshFile, MeshPart
from vrut_lite.scene.mtl_file import portable_name
from vrut_lite.scene.placed import PlacedMesh, check_places, check_triangles
from vrut_lite.scene.scene_file_error import UnreadFile

# Thickness (m) of a pane that a file has as a body: double glazing of 4, 16 and 4 mm.
_BODY_M = 0.024
_GLASS = {
    "": SurfaceTerms(),
    "pane": SurfaceTerms(transmission=1.0),
    "body": SurfaceTerms(transmission=1.0, thickness_m=_BODY_M),
}


def placed_parts(file: MeshFile, folder: SceneFolder, notices: Notices) -> list[PlacedMesh]:
    """The file's meshes at their places.

    Raises:
        SceneFileError: there are too many, or they do not fit the budget.
    """
    for name in file.left_out:
        notices.tell(name, "left out")
    for what, instead, count in file.told:
        notices.tell(what, instead, count)
    makers = _Makers(folder, notices)
    placed: list[PlacedMesh] = []
    triangles = 0
    for part in file.parts:
        triangles += len(part.triangles) // 24
        check_triangles(triangles)
        placed += makers.places(part)
        check_places(len(placed))
    return placed


class _Makers:
    """Makes the meshes of one file, and each of its pictures once."""

    def __init__(self, folder: SceneFolder, notices: Notices) -> None:
        self._folder, self._notices = folder, notices
        self._pixels = PixelBudget(folder.budget)
        self._pictures: dict[str, Image.Image | None] = {}
        self._materials: dict[FileMaterial, SurfaceMaterial] = {}

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
        places = _rows(part.world_from_part, 16)
        names = part.names or [name] * len(places)
        return [PlacedMesh(*one) for one in zip(names, [mesh] * len(places), places, strict=True)]

    def _material(self, source: FileMaterial | None, coloured: bool) -> SurfaceMaterial:
        """A double-sided material: none of these formats has back faces."""
        if source is None:
            if not coloured:
                self._notices.tell_once("mesh without colours", TOLD_GREY)
            material = default_material(coloured)
            material.doubleSided = True
            return material
        if source not in self._materials:
            self._materials[source] = self._made(source)
        return self._materials[source]

    def _made(self, source: FileMaterial) -> SurfaceMaterial:
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
            terms=_GLASS[source.glass],
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

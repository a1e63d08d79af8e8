"""OBJ with its MTL and textures as placed meshes, one for each material."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.file_checks import SceneFolder
from vrut_lite.scene.gltf_points_and_lines import TOLD_STROKES, Strokes
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.mesh import (
    MESH_BYTES,
    Geometry,
    geometry_bytes,
    make_geometry,
    make_mesh,
    used_vertices,
)
from vrut_lite.scene.mtl_file import MtlMaterials, portable_name
from vrut_lite.scene.obj_file import ObjFile, parse_obj
from vrut_lite.scene.obj_strokes import placed_strokes
from vrut_lite.scene.placed import PlacedMesh, check_places, check_triangles
from vrut_lite.scene.scene_file_error import UnreadFile
from vrut_lite.scene.vertex_colours import colours_of_obj


def read_obj_scene(
    path: Path, budget: SceneBudget, notices: Notices
) -> tuple[list[PlacedMesh], list[Strokes]]:
    """The meshes of an OBJ file, one for each material, and its points and lines.

    `notices` takes the warnings.

    Raises:
        SceneFileError: if it is damaged or does not fit the budget.
    """
    folder = SceneFolder(path.parent, budget)
    obj = parse_obj(folder.read(path), budget)
    if obj.colours is not None:
        obj = replace(obj, colours=colours_of_obj(obj.colours, notices))
    check_triangles(len(obj.corners))
    materials = MtlMaterials(_libraries(obj, folder, notices), folder, notices)
    if obj.lost_colours:
        notices.tell("vertex colours of only some vertices of the OBJ", "left out")
    for kind, count in obj.unread.items():
        notices.tell(f"{kind} statement of the OBJ", "not drawn", count)
    placed: list[PlacedMesh] = []
    for group, corners in _groups(obj):
        name = obj.materials[group]
        shown = name or "geometry"
        check_places(len(placed) + 1)
        geometry = _geometry(obj, shown, corners, budget)
        material = materials.make(name, coloured=obj.colours is not None)
        if material.baseColorTexture is not None:
            lacking = np.any(~_exist(corners[..., 1], obj.uv), axis=1).sum()
            instead = "left out" if geometry.uv is None else "in one colour of it"
            notices.tell("triangle without coordinates of its texture", instead, int(lacking))
        placed.append(PlacedMesh(shown, make_mesh(geometry, material), np.eye(4)))
    return placed, _strokes(obj, materials, budget, notices)


def _strokes(
    obj: ObjFile, materials: MtlMaterials, budget: SceneBudget, notices: Notices
) -> list[Strokes]:
    notices.tell("points or lines", TOLD_STROKES, sum(len(one.group) for one in obj.strokes))
    groups = {int(group) for one in obj.strokes for group in one.group}
    coloured = obj.colours is not None
    rgba = {group: materials.colour_rgba(obj.materials[group], coloured) for group in groups}
    return placed_strokes(obj.strokes, obj.positions, obj.colours, rgba, budget)


def _libraries(obj: ObjFile, folder: SceneFolder, notices: Notices) -> list[bytes]:
    """The texts of the material libraries.

    A statement may name several, or one whose name has spaces.
    """
    texts = []
    for said in obj.libraries:
        one = portable_name(said, folder)
        for name in [one] if folder.has(one) else said.split():
            try:
                texts.append(folder.get(portable_name(name, folder)))
            except UnreadFile as fault:
                notices.tell(f"material library {name}", f"{fault.why}, grey instead")
    return texts


def _groups(obj: ObjFile) -> Iterator[tuple[int, NDArray[np.int32]]]:
    """Each material's number and its triangles' corners (F, 3, 3), the last material first."""
    order = np.argsort(obj.group, kind="stable")
    numbers, starts = np.unique(obj.group[order], return_index=True)
    parts = np.split(order, starts)[1:]
    for number, part in reversed(list(zip(numbers, parts, strict=True))):
        yield int(number), obj.corners[part]


def _geometry(obj: ObjFile, name: str, corners: NDArray[np.int32], budget: SceneBudget) -> Geometry:
    """The geometry of some triangles.

    If one corner lacks a normal, or refers to a missing one, the whole mesh goes without them: such
    files are common. Corners without texture coordinates have 0, unless all are without.
    """
    # Each corner may become a vertex, even where the file has normals.
    size_bytes = geometry_bytes(0, len(corners), normals=False, layers=2)
    budget.take(size_bytes + MESH_BYTES, f"mesh {ascii(name)[:60]}")
    named = {"uv": (obj.uv, corners[..., 1]), "NORMAL": (obj.normals, corners[..., 2])}
    given = {}
    for key, (values, at) in named.items():
        exists = _exist(at, values)
        if key == "uv" and exists.any() and not exists.all():
            values = np.concatenate([values, np.zeros((1, values.shape[1]))])
            at, exists = np.where(exists, at, len(values) - 1), np.ones_like(exists)
        if exists.all():
            given[key] = values, at
    places = {"POSITION": obj.positions}
    if obj.colours is not None:
        places["COLOR"] = obj.colours
    faces, arrays = used_vertices(name, corners[..., 0].astype(np.int64), places)
    if given:
        faces, (vertex, *others) = _joined_corners([faces, *(at for _, at in given.values())])
        arrays = {key: values[vertex] for key, values in arrays.items()}
        for (key, (values, _)), at in zip(given.items(), others, strict=True):
            arrays[key] = values[at]
    return make_geometry(
        name,
        arrays["POSITION"],
        faces,
        budget,
        normals=arrays.get("NORMAL"),
        uv=arrays.get("uv"),
        colours=arrays.get("COLOR"),
    )


def _joined_corners(
    corners: Sequence[NDArray[Any]],
) -> tuple[NDArray[np.int64], list[NDArray[Any]]]:
    """One vertex for all corners that agree in every index.

    Args:
        corners: indices (F, 3) of each kind, as positions, texture coordinates and normals.

    Returns:
        The triangles (F, 3), and each kind's index (V,) at the new vertices.
    """
    columns = [indices.reshape(-1) for indices in corners]
    order = np.lexsort(columns[::-1])
    is_first = np.ones(len(order), bool)
    is_first[1:] = np.any([kind[order[1:]] != kind[order[:-1]] for kind in columns], axis=0)
    vertex = np.empty(len(order), np.int64)
    vertex[order] = np.cumsum(is_first) - 1
    return vertex.reshape(-1, 3), [kind[order[is_first]] for kind in columns]


def _exist(corners: NDArray[np.int32], values: NDArray[np.float64]) -> NDArray[np.bool_]:
    return (corners >= 0) & (corners < len(values))

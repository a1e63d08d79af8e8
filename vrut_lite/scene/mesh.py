"""Makes checked triangle meshes from the arrays of the file readers."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.materials import SurfaceMaterial
from vrut_lite.scene.normals import crease_normals, unit_or_none
from vrut_lite.scene.scene_file_error import SceneFileError

# Fixed memory of a mesh: objects here, buffers in the renderer.
MESH_BYTES = 2**15
_CORNER_BYTES, _FACE_BYTES, _LAYER_BYTES = 48, 24, 16


@dataclass(frozen=True, eq=False)
class Geometry:
    """Triangles without their material; meshes of several materials may share them.

    vertices (V, 3) in metres, faces (F, 3), unit normals (V, 3), texture coordinates (V, 2) with
    v upwards, colours (V, 4) linear in [0, 1].
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    normals: NDArray[np.float64]
    uv: NDArray[np.float64] | None
    second_uv: NDArray[np.float64] | None
    colours: NDArray[np.float32] | None


@dataclass(frozen=True, eq=False)
class TriangleMesh(Geometry):
    """Triangles of one material."""

    material: SurfaceMaterial


def geometry_bytes(vertices: int, triangles: int, *, normals: bool, layers: int) -> int:
    """The most bytes that a geometry holds.

    `normals`: whether the file has them; if not, every corner may become a vertex. `layers`: the
    number of sets of texture coordinates and colours.
    """
    corners = min(vertices, 3 * triangles) if normals else 3 * triangles
    return corners * (_CORNER_BYTES + layers * _LAYER_BYTES) + triangles * _FACE_BYTES


def used_vertices(
    name: str, faces: NDArray[np.int64], arrays: dict[str, NDArray[Any]]
) -> tuple[NDArray[np.int64], dict[str, NDArray[Any]]]:
    """Drop unused vertices: the renumbered triangles (F, 3) and the arrays (V, components).

    Raises:
        SceneFileError: for indices out of range, or arrays of different lengths.
    """
    shown = ascii(name)[:60]
    count = len(arrays["POSITION"])
    if faces.min() < 0 or faces.max() >= count:
        raise SceneFileError(
            f"mesh {shown} refers to vertex {faces.max()}, and it has {count}; export it again"
        )
    for kind, values in arrays.items():
        if len(values) != count:
            raise SceneFileError(
                f"mesh {shown} has {len(values)} {kind!a} for {count} vertices; export it again"
            )
    used, faces = _renumbered(faces, count)
    return faces, {kind: values[used] for kind, values in arrays.items()}


def _renumbered(
    faces: NDArray[np.int64], vertices: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The vertices (U,) in use, in order, and the triangles (F, 3) as indices into them."""
    if vertices > 2 * faces.size:  # Sorting few used numbers is cheaper than marking all.
        used, faces_of_used = np.unique(faces, return_inverse=True)
        return used, faces_of_used.reshape(-1, 3)
    in_use = np.zeros(vertices, bool)
    in_use[faces] = True
    number = np.cumsum(in_use) - 1
    return np.flatnonzero(in_use), number[faces]


def make_geometry(
    name: str,
    positions: NDArray[Any],
    faces: NDArray[np.int64],
    budget: SceneBudget,
    *,
    normals: NDArray[Any] | None = None,
    uv: NDArray[Any] | None = None,
    second_uv: NDArray[Any] | None = None,
    colours: NDArray[Any] | None = None,
) -> Geometry:
    """A geometry with unit normals.

    Args:
        name: for errors.
        positions: (V, 3), metres.
        faces: (F, 3) vertex indices in range, at least one.
        budget: has counted `geometry_bytes`; counts more if bad normals are replaced.
        normals: (V, 3) as authored; computed if absent, or if one of them has no direction.
        uv, second_uv: (V, 2) texture coordinates, v upwards.
        colours: (V, 3) or (V, 4), linear, in [0, 1].

    Raises:
        SceneFileError: for values that are not finite, or arrays of the wrong width.
    """
    _check_widths(name, positions, normals, uv, second_uv, colours)
    vertices = positions.astype(np.float64)
    if not np.all(np.isfinite(vertices)):
        raise SceneFileError(
            f"mesh {ascii(name)[:60]} has vertices that are not finite numbers; export it again"
        )
    unit = None if normals is None else unit_or_none(normals.astype(np.float64))
    source: Any = slice(None)
    if unit is None:
        if normals is not None:
            more = geometry_bytes(0, len(faces), normals=False, layers=3)
            budget.take(more, f"mesh {ascii(name)[:60]}")
        source, faces, unit = crease_normals(vertices, faces)
        vertices = vertices[source]
    return Geometry(
        vertices,
        faces,
        unit,
        None if uv is None else _finite(uv)[source],
        None if second_uv is None else _finite(second_uv)[source],
        None if colours is None else _rgba(colours)[source],
    )


def make_mesh(geometry: Geometry, material: SurfaceMaterial) -> TriangleMesh:
    """A mesh of one material; it shares the geometry's arrays."""
    return TriangleMesh(**vars(geometry), material=material)


def mirrored(mesh: TriangleMesh, budget: SceneBudget) -> TriangleMesh:
    """The same mesh with its triangles wound the other way, for a matrix that mirrors it.

    Raises:
        SceneFileError: if the second list of triangles does not fit the budget.
    """
    budget.take(len(mesh.faces) * _FACE_BYTES + MESH_BYTES, "a mirrored mesh")
    return replace(mesh, faces=mesh.faces[:, ::-1].copy())


def _check_widths(
    name: str,
    positions: NDArray[Any],
    normals: NDArray[Any] | None,
    uv: NDArray[Any] | None,
    second_uv: NDArray[Any] | None,
    colours: NDArray[Any] | None,
) -> None:
    for kind, values, widths in (
        ("positions", positions, (3,)),
        ("normals", normals, (3,)),
        ("texture coordinates", uv, (2,)),
        ("second texture coordinates", second_uv, (2,)),
        ("colours", colours, (3, 4)),
    ):
        if values is not None and values.shape[1] not in widths:
            raise SceneFileError(
                f"mesh {ascii(name)[:60]} has {kind} of {values.shape[1]} numbers each; "
                "export it again"
            )


def _finite(uv: NDArray[Any]) -> NDArray[np.float64]:
    return np.nan_to_num(uv.astype(np.float64), posinf=0, neginf=0)


def _rgba(colours: NDArray[Any]) -> NDArray[np.float32]:
    rgba = np.ones((len(colours), 4), np.float32)
    rgba[:, : colours.shape[1]] = np.clip(np.nan_to_num(colours), 0.0, 1.0)
    return rgba

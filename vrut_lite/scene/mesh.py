"""One triangle mesh, checked: what every reader hands its arrays to."""

from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh.visual.texture import TextureVisuals

from vrut_lite.scene.file_checks import SceneFileError
from vrut_lite.scene.materials import SurfaceMaterial
from vrut_lite.scene.normals import crease_normals, unit_or_none

_WIDTHS = {
    "normals": (3,),
    "texture coordinates": (2,),
    "second texture coordinates": (2,),
    "colours": (3, 4),
}


def make_mesh(
    name: str,
    positions: NDArray[Any],
    faces: NDArray[np.int64],
    *,
    material: SurfaceMaterial,
    normals: NDArray[Any] | None = None,
    uv: NDArray[Any] | None = None,
    second_uv: NDArray[Any] | None = None,
    colours: NDArray[Any] | None = None,
) -> trimesh.Trimesh | None:
    """A mesh with unit normals, a material, and vertices that are all in use.

    Args:
        name: told in errors.
        positions: (V, 3), metres.
        faces: (F, 3) vertex indices.
        material: of the whole mesh.
        normals: (V, 3) as authored; without them, or with a bad one among them, they are made.
        uv, second_uv: (V, 2) texture coordinates, v upwards.
        colours: (V, 3) or (V, 4), linear, in [0, 1].

    Returns:
        The mesh, or None if there are no triangles.

    Raises:
        SceneFileError: for indices out of range, values that are not finite, or arrays of
            different lengths.
    """
    if len(faces) == 0:
        return None
    attributes = {
        "normals": normals,
        "texture coordinates": uv,
        "second texture coordinates": second_uv,
        "colours": colours,
    }
    _check(name, positions, faces, attributes)
    used, faces = np.unique(faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    vertices = positions[used].astype(np.float64)
    if not np.all(np.isfinite(vertices)):
        raise SceneFileError(
            f"mesh {ascii(name)[:60]} has vertices that are not finite numbers; export it again"
        )
    unit = None if normals is None else unit_or_none(normals[used].astype(np.float64))
    if unit is None:
        source, faces, unit = crease_normals(vertices, faces)
        vertices, used = vertices[source], used[source]
    visual = TextureVisuals(uv=None if uv is None else _finite(uv)[used], material=material)
    mesh = trimesh.Trimesh(vertices, faces, vertex_normals=unit, visual=visual, process=False)
    if second_uv is not None:
        mesh.vertex_attributes["second_uv"] = _finite(second_uv)[used]
    if colours is not None:
        mesh.vertex_attributes["color"] = _rgba(colours[used])
    return mesh


def mirrored(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """The same mesh with its triangles wound the other way, for a matrix that mirrors it."""
    copy = trimesh.Trimesh(
        mesh.vertices,
        mesh.faces[:, ::-1],
        vertex_normals=mesh.vertex_normals,
        visual=TextureVisuals(
            uv=getattr(mesh.visual, "uv", None), material=getattr(mesh.visual, "material", None)
        ),
        process=False,
    )
    copy.vertex_attributes.update(mesh.vertex_attributes)
    return copy


def _check(
    name: str,
    positions: NDArray[Any],
    faces: NDArray[np.int64],
    attributes: dict[str, NDArray[Any] | None],
) -> None:
    shown = ascii(name)[:60]
    if positions.shape[1] != 3:
        raise SceneFileError(f"mesh {shown} has positions that are not in space; export it again")
    if faces.min() < 0 or faces.max() >= len(positions):
        raise SceneFileError(
            f"mesh {shown} refers to vertex {faces.max()}, and it has {len(positions)}; "
            "export it again"
        )
    for kind, values in attributes.items():
        if values is None:
            continue
        if len(values) != len(positions):
            raise SceneFileError(
                f"mesh {shown} has {len(values)} {kind} for {len(positions)} vertices; "
                "export it again"
            )
        if values.shape[1] not in _WIDTHS[kind]:
            raise SceneFileError(
                f"mesh {shown} has {kind} of {values.shape[1]} numbers each; export it again"
            )


def _finite(uv: NDArray[Any]) -> NDArray[np.float64]:
    return np.nan_to_num(uv.astype(np.float64), posinf=0, neginf=0)


def _rgba(colours: NDArray[Any]) -> NDArray[np.float32]:
    rgba = np.ones((len(colours), 4), np.float32)
    rgba[:, : colours.shape[1]] = np.clip(np.nan_to_num(colours), 0.0, 1.0)
    return rgba

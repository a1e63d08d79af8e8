"""Placed meshes and the ground as shapes of mitsuba, in the tracer's units from the eye.

A mesh that stands in several places is kept once and instanced, unless it glows or its vertices
have colours. Like the GL frame's, its vertices count from the middle of its bounds, and the
place's matrix is put together in double precision, so that single precision suffices for both.
"""

from collections import Counter
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from path_tracer.settings import SurfaceModel
from path_tracer.subject import Subject
from path_tracer.surfaces import (
    VERTEX_COLOUR,
    Plugin,
    colours_vary,
    emission,
    matte,
    painted_vertices,
    surface,
)
from vrut_lite.scene.ground_disc import triangulate
from vrut_lite.scene.materials import SurfaceMaterial

# Flatter than this, a matrix has no usable inverse in single precision.
_FLAT = 1e-5


def shapes(mitsuba: Any, subject: Subject, model: SurfaceModel = "gltf") -> dict[str, Any]:
    """All shapes of a scene by name, none of which glows; `model` as for `surface`."""
    times = Counter(id(placed.mesh) for placed in subject.scene.meshes)
    groups: dict[int, Any] = {}
    result: dict[str, Any] = {}
    for number, placed in enumerate(subject.scene.meshes):
        matrix = subject.units_from_world() @ placed.world_from_model
        name, mesh = f"shape_{number}", placed.mesh
        if times[id(mesh)] == 1 or _glows(mesh) or _is_painted(mesh) or _is_flat(matrix):
            result[name] = _mesh(mitsuba, mesh, matrix, model)
            continue
        centre = _centre(mesh)
        if id(mesh) not in groups:
            back = np.eye(4)
            back[:3, 3] = -centre
            groups[id(mesh)] = mitsuba.load_dict(
                {"type": "shapegroup", "mesh": _mesh(mitsuba, mesh, back, model)}
            )
            result[f"{name}_group"] = groups[id(mesh)]
        place = matrix.copy()
        place[:3, 3] += matrix[:3, :3] @ centre
        result[name] = {
            "type": "instance",
            "to_world": mitsuba.ScalarTransform4f(place),
            "group": groups[id(mesh)],
        }
    if subject.ground is not None:
        result["ground"] = _ground(mitsuba, subject)
    return result


def glowing_shapes(mitsuba: Any, subject: Subject, model: SurfaceModel = "gltf") -> dict[str, Any]:
    """The shapes that shine, under the names that they have in `shapes`."""
    units = subject.units_from_world()
    return {
        f"shape_{number}": _mesh(
            mitsuba, placed.mesh, units @ placed.world_from_model, model, glowing=True
        )
        for number, placed in enumerate(subject.scene.meshes)
        if _glows(placed.mesh)
    }


def _mesh(
    mitsuba: Any,
    mesh: trimesh.Trimesh,
    matrix: NDArray[np.float64],
    model: SurfaceModel,
    glowing: bool = False,
) -> Any:
    """A shape whose vertices are moved by the matrix (4, 4) in double precision."""
    material: SurfaceMaterial = mesh.visual.material  # type: ignore[union-attr]
    layer = material.layer_of.get("baseColorTexture", 0)
    uv = _coordinates(mesh, layer)
    attributes = mesh.vertex_attributes
    colours = np.asarray(attributes["color"]) if "color" in attributes else None
    made = _new_mesh(
        mitsuba,
        vertices=np.asarray(mesh.vertices) @ matrix[:3, :3].T + matrix[:3, 3],
        normals=_moved_normals(np.asarray(mesh.vertex_normals), matrix),
        faces=np.asarray(mesh.faces),
        uv=uv,
        bsdf=surface(mitsuba, material, layer, colours, model),
        emitter=emission(mitsuba, material, layer, _repeats(uv)) if glowing else None,
    )
    if colours is not None:
        painted = painted_vertices(material, layer, colours)
        made.add_attribute(VERTEX_COLOUR, painted.shape[1], painted.ravel())
    return made


def _ground(mitsuba: Any, subject: Subject) -> Any:
    """The ground disc, triangle for triangle that of the GL frame."""
    assert subject.ground is not None
    vertices, triangles = triangulate(subject.ground)
    x, z = subject.ground.centre_xz_m
    matrix = subject.units_from_world()
    world_m = vertices.astype(np.float64) + np.array([x, subject.ground.height_m, z])
    return _new_mesh(
        mitsuba,
        vertices=world_m @ matrix[:3, :3].T + matrix[:3, 3],
        normals=np.tile([0.0, 1.0, 0.0], (len(vertices), 1)),
        faces=triangles,
        uv=None,
        bsdf=matte(subject.ground_albedo),
        emitter=None,
    )


def _new_mesh(
    mitsuba: Any,
    vertices: NDArray[np.float64],
    normals: NDArray[np.float64],
    faces: NDArray[Any],
    uv: NDArray[np.float64] | None,
    bsdf: Plugin,
    emitter: Plugin | None,
) -> Any:
    properties = mitsuba.Properties()
    properties["mesh_bsdf"] = mitsuba.load_dict(bsdf)
    if emitter is not None:
        properties["emitter"] = mitsuba.load_dict(emitter)
    made = mitsuba.Mesh(
        "mesh",
        vertex_count=len(vertices),
        face_count=len(faces),
        props=properties,
        has_vertex_normals=True,
        has_vertex_texcoords=uv is not None,
    )
    values = mitsuba.traverse(made)
    values["vertex_positions"] = vertices.astype(np.float32).ravel()
    values["vertex_normals"] = normals.astype(np.float32).ravel()
    values["faces"] = np.asarray(faces, np.uint32).ravel()
    if uv is not None:
        values["vertex_texcoords"] = uv.astype(np.float32).ravel()
    values.update()
    return made


def _moved_normals(normals: NDArray[Any], matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit normals (V, 3) by the matrix of cofactors, which a flat matrix has too.

    Its sign is that of the determinant; a mirrored mesh was wound anew, and keeps its outside.
    """
    a, b, c = matrix[:3, :3].T
    cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        cofactors = -cofactors
    moved = normals @ cofactors.T
    length = np.linalg.norm(moved, axis=1, keepdims=True)
    return np.asarray(moved / np.maximum(length, np.finfo(float).tiny))


def _coordinates(mesh: trimesh.Trimesh, layer: int) -> NDArray[np.float64] | None:
    """glTF's own texture coordinates (V, 2), v downwards."""
    uv = mesh.vertex_attributes.get("second_uv") if layer else getattr(mesh.visual, "uv", None)
    if uv is None:
        return None
    values = np.asarray(uv, dtype=float)
    return np.stack([values[:, 0], 1.0 - values[:, 1]], axis=1)


def _repeats(uv: NDArray[np.float64] | None) -> bool:
    return uv is None or bool(uv.min() < -1e-3 or uv.max() > 1.0 + 1e-3)


def _glows(mesh: trimesh.Trimesh) -> bool:
    """Whether it shines by itself: mitsuba instances no emitters."""
    return bool(np.any(np.asarray(mesh.visual.material.emissiveFactor) > 0.0))  # type: ignore[union-attr]


def _is_painted(mesh: trimesh.Trimesh) -> bool:
    """Whether vertices colour it: mitsuba takes an instance's place for one on the mesh itself."""
    colours = mesh.vertex_attributes.get("color")
    return colours is not None and colours_vary(np.asarray(colours))


def _is_flat(matrix: NDArray[np.float64]) -> bool:
    scales = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    return bool(scales[2] <= _FLAT * scales[0])


def _centre(mesh: trimesh.Trimesh) -> NDArray[np.float64]:
    vertices = np.asarray(mesh.vertices)
    return np.asarray(0.5 * (vertices.min(axis=0) + vertices.max(axis=0)))

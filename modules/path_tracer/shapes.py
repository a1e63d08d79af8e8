"""Placed meshes and the ground as shapes of mitsuba, in the tracer's units from the eye.

A mesh that stands in several places is kept once and instanced, unless it glows or its vertices
have colours. Like the GL frame's, its vertices count from the middle of its bounds, and the
place's matrix is put together in double precision, so that single precision suffices for both.
"""

from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from path_tracer.opened_bodies import IS_BODY, in_bodies
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
from vrut_lite.messages.ground_disc import GroundDisc, triangulate
from vrut_lite.messages.scene_content import Material, Mesh

# Flatter than this, a matrix has no usable inverse in single precision.
_FLAT = 1e-5
# No map lies on it: of meshes without texture coordinates.
_NO_LAYER = -1


class TracedShapes(NamedTuple):
    """Shapes by name, the BSDFs of those that are single-sided, and the ground disc's."""

    shapes: dict[str, Any]
    one_sided: list[Any]
    ground: Any = None


def matter(mitsuba: Any, subject: Subject, model: SurfaceModel = "gltf") -> TracedShapes:
    """All of a scene, none of which glows; `model` as for `surface`."""
    geometry = subject.scene.geometry
    skins = _skins(subject)
    times = Counter(geometry.part_mesh.values.tolist())
    groups: dict[int, Any] = {}
    bsdfs = _Bsdfs(mitsuba, model, subject)
    result: dict[str, Any] = {}
    for part, (number, world_from_mesh) in enumerate(_places(subject)):
        matrix = subject.units_from_world() @ world_from_mesh
        name, skin = f"shape_{part}", skins[number]
        if times[number] == 1 or skin.glows or skin.is_painted or not _is_instanced(matrix):
            result[name] = _mesh(mitsuba, skin, matrix, model, bsdfs)
            continue
        centre = _centre(skin.mesh)
        if number not in groups:
            back = np.eye(4)
            back[:3, 3] = -centre
            groups[number] = mitsuba.load_dict(
                {"type": "shapegroup", "mesh": _mesh(mitsuba, skin, back, model, bsdfs)}
            )
            result[f"{name}_group"] = groups[number]
        place = matrix.copy()
        place[:3, 3] += matrix[:3, :3] @ centre
        result[name] = {
            "type": "instance",
            "to_world": mitsuba.ScalarTransform4f(place),
            "group": groups[number],
        }
    if subject.scene.ground is None:
        return TracedShapes(result, bsdfs.one_sided)
    soil = mitsuba.load_dict(matte(np.asarray(subject.state.ground_albedo_rgb)))
    result["ground"] = _ground(mitsuba, subject, subject.scene.ground, soil)
    return TracedShapes(result, bsdfs.one_sided, soil)


def glowing_shapes(mitsuba: Any, subject: Subject, model: SurfaceModel = "gltf") -> TracedShapes:
    """The shapes that shine, under the names that they have in `matter`."""
    units = subject.units_from_world()
    skins, bsdfs = _skins(subject), _Bsdfs(mitsuba, model, subject)
    shining = {
        f"shape_{part}": _mesh(mitsuba, skins[number], units @ matrix, model, bsdfs, glowing=True)
        for part, (number, matrix) in enumerate(_places(subject))
        if skins[number].glows
    }
    return TracedShapes(shining, bsdfs.one_sided)


class _Skin(NamedTuple):
    """A mesh and what it is made of."""

    mesh: Mesh
    material: Material

    @property
    def glows(self) -> bool:
        """Whether it shines by itself: mitsuba instances no emitters."""
        return bool(np.any(self.material.emission_rgb > 0.0))

    @property
    def is_painted(self) -> bool:
        """Whether vertices colour it: mitsuba takes an instance's place for the mesh's own."""
        colours = self.mesh.colours_rgba
        return colours is not None and colours_vary(colours)

    @property
    def is_opaque(self) -> bool:
        """Whether no light passes it."""
        return self.material.alpha_mode == "OPAQUE" and not self.material.terms.transmits

    @property
    def layer(self) -> int:
        """The layer of texture coordinates that its maps lie on; none of theirs if it has none."""
        base_colour = self.material.maps.get("base_colour")
        layer = 0 if base_colour is None else base_colour.uv_layer
        return _NO_LAYER if _coordinates(self.mesh, layer) is None else layer


class _Bsdfs:
    """One BSDF for all meshes of a material, so that llvm kernels compile in seconds."""

    def __init__(self, mitsuba: Any, model: SurfaceModel, subject: Subject):
        self._mitsuba, self._model, self._units_per_m = mitsuba, model, subject.units_per_m
        self.is_cut = subject.state.section is not None
        self._made: dict[tuple[int, int, bytes], Any] = {}
        self.one_sided: list[Any] = []

    def of(self, skin: _Skin) -> Any:
        """The mesh's BSDF."""
        colours = skin.mesh.colours_rgba
        # Vertices' colours are the mesh's attribute, or one factor of all its colours.
        own = b"" if colours is None else colours[: None if skin.is_painted else 1].tobytes()
        if skin.is_painted and self._model == "layered":
            own = b"attribute"
        key = (skin.mesh.material, skin.layer, own)
        if key not in self._made:
            made = surface(
                self._mitsuba,
                skin.material,
                skin.layer,
                colours,
                self._model,
                self._units_per_m,
            )
            self._made[key] = self._mitsuba.load_dict(made)
            if not skin.material.double_sided:
                self.one_sided.append(self._made[key])
        return self._made[key]


def _skins(subject: Subject) -> list[_Skin]:
    geometry, materials = subject.scene.geometry, subject.scene.materials.all()
    meshes = map(geometry.mesh, range(geometry.mesh_count))
    return [_Skin(mesh, materials[mesh.material]) for mesh in meshes]


def _places(subject: Subject) -> Iterator[tuple[int, NDArray[np.float64]]]:
    """The number of each part's mesh, and its matrix (4, 4) to the world."""
    geometry = subject.scene.geometry
    numbers: list[int] = geometry.part_mesh.values.tolist()
    return zip(numbers, geometry.world_from_part.values, strict=True)


def _mesh(
    mitsuba: Any,
    skin: _Skin,
    matrix: NDArray[np.float64],
    model: SurfaceModel,
    bsdfs: _Bsdfs,
    glowing: bool = False,
) -> Any:
    """A shape whose vertices are moved by the matrix (4, 4) in double precision."""
    mesh, material = skin
    layer = skin.layer
    uv = _coordinates(mesh, layer)
    colours = mesh.colours_rgba
    made = _new_mesh(
        mitsuba,
        vertices=mesh.positions_m @ matrix[:3, :3].T + matrix[:3, 3],
        normals=_moved_normals(mesh.normals, matrix),
        faces=mesh.triangles,
        uv=uv,
        bsdf=bsdfs.of(skin),
        emitter=emission(mitsuba, material, layer, _repeats(uv)) if glowing else None,
    )
    if bsdfs.is_cut:
        inside_is_dark = in_bodies(mesh) & skin.is_opaque
        made.add_attribute(IS_BODY, 1, inside_is_dark.astype(np.float32))
    if colours is not None:
        painted = painted_vertices(material, layer, colours, model)
        made.add_attribute(VERTEX_COLOUR, painted.shape[1], painted.ravel())
    return made


def _ground(mitsuba: Any, subject: Subject, ground: GroundDisc, bsdf: Any) -> Any:
    """The ground disc, of the same triangles as in the GL frame."""
    vertices, triangles = triangulate(ground)
    x, z = ground.centre_xz_m
    matrix = subject.units_from_world()
    world_m = vertices.astype(np.float64) + np.array([x, ground.height_m, z])
    return _new_mesh(
        mitsuba,
        vertices=world_m @ matrix[:3, :3].T + matrix[:3, 3],
        normals=np.tile([0.0, 1.0, 0.0], (len(vertices), 1)),
        faces=triangles,
        uv=None,
        bsdf=bsdf,
        emitter=None,
    )


def _new_mesh(
    mitsuba: Any,
    vertices: NDArray[np.float64],
    normals: NDArray[np.float64],
    faces: NDArray[Any],
    uv: NDArray[np.float64] | None,
    bsdf: Any,
    emitter: Plugin | None,
) -> Any:
    properties = mitsuba.Properties()
    properties["mesh_bsdf"] = bsdf
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

    Its sign is that of the determinant; a mirrored mesh's winding is reversed and keeps its
    outside.
    """
    a, b, c = matrix[:3, :3].T
    cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        cofactors = -cofactors
    moved = normals @ cofactors.T
    length = np.linalg.norm(moved, axis=1, keepdims=True)
    return np.asarray(moved / np.maximum(length, np.finfo(float).tiny))


def _coordinates(mesh: Mesh, layer: int) -> NDArray[np.float64] | None:
    """glTF's own texture coordinates (V, 2), v downwards."""
    uv = mesh.second_uv if layer == 1 else mesh.uv
    return None if uv is None else np.stack([uv[:, 0], 1.0 - uv[:, 1]], axis=1)


def _repeats(uv: NDArray[np.float64] | None) -> bool:
    return uv is None or bool(uv.min() < -1e-3 or uv.max() > 1.0 + 1e-3)


def _is_instanced(matrix: NDArray[np.float64]) -> bool:
    """Whether mitsuba may place a mesh by this matrix: it has an inverse, and mirrors nothing."""
    scales = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    return bool(scales[2] > _FLAT * scales[0] and np.linalg.det(matrix[:3, :3]) > 0.0)


def _centre(mesh: Mesh) -> NDArray[np.float64]:
    return np.asarray(0.5 * (mesh.positions_m.min(axis=0) + mesh.positions_m.max(axis=0)))

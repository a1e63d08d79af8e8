"""A loaded scene as a pyrender scene: its meshes, materials and the ground disc."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.frame_part import GROUND, MeshChart
from vrut_lite.messages.ground_disc import GroundDisc, inner_and_outer
from vrut_lite.messages.points_and_lines import PointsAndLines
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.scene_content import MapName, Material, Mesh
from vrut_lite.messages.surface_terms import SurfaceTerms
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.render.colour_texture import is_cut_out, textures_of
from vrut_lite.render.gl_environment import import_pyrender

pyrender = import_pyrender()
GL_POINTS, GL_LINES = 0, 1
_TRIANGLES_AT_A_TIME = 1 << 15
# Smallest size (texels) of a chart, to divide by.
_LEAST_CHART_PX = 1e-6


@dataclass(frozen=True, eq=False)
class PlacedPrimitive:
    """A pyrender primitive and its placement.

    `centre_m` (3,) and `radius_m` are a bounding sphere. The matrix (4, 4) is not given to
    pyrender, which would decompose it and fail for a singular one. `part` is as in `PlacedSurface`.
    Shadow maps leave out primitives unless `casts`.
    """

    primitive: Any
    world_from_model: FloatArray
    centre_m: FloatArray
    radius_m: float
    part: int | None = None
    casts: bool = True

    @property
    def is_ground(self) -> bool:
        """Whether it belongs to the ground disc."""
        return self.part == GROUND

    @property
    def is_two_sided(self) -> bool:
        """Whether its back faces are drawn."""
        return bool(self.primitive.material.doubleSided)

    @cached_property
    def hole_m(self) -> float:
        """Radius of the hole in the middle of a part of the ground disc, 0 without one."""
        return float(np.linalg.norm(self.primitive.positions[:, ::2], axis=1).min())

    @cached_property
    def is_mirrored(self) -> bool:
        """Whether its placement reverses its triangles' winding, or is singular."""
        return bool(np.linalg.det(self.world_from_model[:3, :3]) <= 0.0)


@dataclass(frozen=True, eq=False)
class _Cut:
    """A mesh to upload, and the matrix (4, 4) that moves its centred vertices back."""

    primitive: Any
    model_from_centred: FloatArray

    @property
    def primitives(self) -> list[Any]:
        """The primitives of a mesh, as pyrender's renderer reads them."""
        return [self.primitive]


class Uploads(NamedTuple):
    """Attributes of a scene that pyrender's renderer reads to upload buffers."""

    meshes: set[_Cut]
    lights: tuple[()] = ()


class PyrenderScene:
    """Meshes whose buffers pyrender keeps, their placements, and the ground's material.

    pyrender uploads `uploads`; the passes draw `placed`.
    """

    def __init__(self, opened: SceneOpened):
        self._opened = opened
        lower_m, upper_m = np.asarray(opened.lower_m), np.asarray(opened.upper_m)
        self.centre_m = 0.5 * (lower_m + upper_m)
        self.half_extent_m = 0.5 * (upper_m - lower_m)
        self.radius_m = max(float(np.linalg.norm(self.half_extent_m)), 1e-6)
        ground = opened.ground
        # Level of the ground behind the scene, and centre of its disc.
        self.ground_level_m = 0.0 if ground is None else ground.height_m
        self.ground_centre_xz_m = np.array((0.0, 0.0) if ground is None else ground.centre_xz_m)
        self._surfaces = [_surface(material) for material in opened.materials.all()]
        # Whether a surface transmits a part of the sun's light.
        self.dims_sun = any(
            surface.terms.transmits or surface.alphaMode == "BLEND" for surface in self._surfaces
        )
        self._strokes = _strokes(opened.points_and_lines)
        self._ground = () if ground is None else _ground(ground)
        # By mesh number and the mesh's chart in a frame part's map.
        self._cuts: dict[tuple[int, MeshChart | None], _Cut] = {}
        self._charts: Sequence[MeshChart | None] | None = None
        self._place()

    def lay_out(self, charts: Sequence[MeshChart | None] | None) -> None:
        """Cut meshes into the charts of the scene's parts; uncut meshes keep their buffers."""
        if charts is not self._charts:
            self._charts = charts
            self._place()

    def _place(self) -> None:
        geometry = self._opened.geometry
        whole = {key: cut for key, cut in self._cuts.items() if key[1] is None}
        self._cuts, self.uploads, self.placed = {}, Uploads(set()), []
        meshes = geometry.part_mesh.values.tolist()
        charts = self._charts or [None] * len(meshes)
        for part, key in enumerate(zip(meshes, charts, strict=True)):
            if key not in self._cuts:
                self._cuts[key] = whole.get(key) or self._cut(*key)
                self.uploads.meshes.add(self._cuts[key])
            matrix = geometry.world_from_part.values[part] @ self._cuts[key].model_from_centred
            self.placed.append(_placed(self._cuts[key].primitive, matrix, part=part))
        for stroke in self._strokes:
            self.uploads.meshes.add(stroke)
            self.placed.append(_placed(stroke.primitive, stroke.model_from_centred, casts=False))
        for cut in self._ground:
            self.uploads.meshes.add(cut)
            ground = cut.primitive, cut.model_from_centred
            self.placed.append(_placed(*ground, part=GROUND, casts=False))

    def paint_ground(self, albedo_rgb: Vector) -> None:
        """Give the ground disc an albedo, linear RGB in [0, 1]."""
        for cut in self._ground:
            cut.primitive.material.baseColorFactor = [*albedo_rgb, 1.0]

    def _cut(self, number: int, chart: MeshChart | None) -> _Cut:
        mesh = self._opened.geometry.mesh(number)
        return _cut_up(mesh, self._surfaces[mesh.material], chart)


def _placed(primitive: Any, matrix: FloatArray, **more: Any) -> PlacedPrimitive:
    # Vertices are relative to the centre of their bounds, which is the matrix's translation.
    largest = float(np.linalg.norm(primitive.positions, axis=1).max(initial=0.0))
    radius_m = largest * float(np.linalg.norm(matrix[:3, :3], ord=2))
    return PlacedPrimitive(primitive, matrix, matrix[:3, 3], radius_m, **more)


def _strokes(found: PointsAndLines | None) -> list[_Cut]:
    """Points and lines, unlit, as glTF requires without normals."""
    if found is None:
        return []
    made = []
    for mode, places, rgba in (
        (GL_POINTS, found.points_m.values, found.point_rgba.values),
        (GL_LINES, found.lines_m.values, found.line_rgba.values),
    ):
        if not places.size:
            continue
        places, middle = places.reshape(-1, 3), np.eye(4)
        middle[:3, 3] = 0.5 * (places.min(axis=0) + places.max(axis=0))
        surface = Surface(doubleSided=True)
        surface.terms, surface.matte = SurfaceTerms(unlit=1.0), True
        primitive = pyrender.Primitive(
            positions=(places - middle[:3, 3]).astype(np.float32),
            color_0=rgba.reshape(-1, 4),
            material=surface,
            mode=mode,
        )
        # They have no sides: drawn once, not front and back.
        primitive.wound_as_normals = False
        made.append(_Cut(primitive, middle))
    return made


def _ground(ground: GroundDisc) -> tuple[_Cut, ...]:
    # Matte, without the reflection of a dielectric: the disc then has the radiance
    # albedo * E / pi of the sky's own lower half, and its rim does not show.
    material = Surface(
        baseColorFactor=[0.1, 0.1, 0.1, 1.0], metallicFactor=0.0, roughnessFactor=1.0
    )
    material.matte = True
    middle = np.eye(4)
    middle[:3, 3] = [ground.centre_xz_m[0], ground.height_m, ground.centre_xz_m[1]]
    primitives = (
        pyrender.Primitive(
            positions=vertices,
            normals=np.tile(np.array([0, 1, 0], np.float32), (len(vertices), 1)),
            indices=triangles,
            material=material,
        )
        for vertices, triangles in inner_and_outer(ground)
    )
    return tuple(_Cut(primitive, middle) for primitive in primitives)


def _cut_up(mesh: Mesh, surface: "Surface", chart: MeshChart | None) -> _Cut:
    """A mesh with centred vertices, split as in its chart in a part's map.

    Single precision then resolves the mesh independently of the distance of its origin.
    """
    centre = 0.5 * (mesh.positions_m.min(axis=0) + mesh.positions_m.max(axis=0))
    vertices = slice(None) if chart is None else chart.source_vertex

    def values(array: NDArray | None) -> Any:
        return None if array is None else np.asarray(array, np.float32)[vertices]

    primitive = pyrender.Primitive(
        positions=(mesh.positions_m - centre).astype(np.float32)[vertices],
        normals=values(mesh.normals),
        # Our shaders need no tangents: that attribute holds texture coordinates in a part's map.
        tangents=None if chart is None else np.pad(chart.uv, ((0, 0), (0, 2))),
        texcoord_0=values(mesh.uv),
        texcoord_1=values(mesh.second_uv),
        color_0=values(mesh.colours_rgba),
        indices=np.asarray((mesh if chart is None else chart).triangles, np.uint32),
        material=surface,
    )
    primitive.wound_as_normals = _wound_as_normals(primitive)
    primitive.chart_px = _chart_px(chart)
    model_from_centred = np.eye(4)
    model_from_centred[:3, 3] = centre
    return _Cut(primitive, model_from_centred)


def _chart_px(chart: MeshChart | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """First corner (2,) and size (2,) of a chart, in texels; of 1 without one."""
    if chart is None or not len(chart.uv):
        return np.zeros(2), np.ones(2)
    first = chart.uv.min(axis=0).astype(float)
    return first, np.maximum(chart.uv.max(axis=0) - first, _LEAST_CHART_PX)


class Surface(pyrender.MetallicRoughnessMaterial):  # type: ignore[name-defined]
    """pyrender's material, and the parameters that it lacks."""

    layer_of: Mapping[MapName, int] = MappingProxyType({})
    # The textures of glTF's extensions.
    further: Mapping[MapName, Any] = MappingProxyType({})
    terms = SurfaceTerms()
    normal_scale = 1.0
    occlusion_strength = 1.0
    # Whether the base colour map is cut out, at an alpha of one half.
    is_cut_out = False
    # Lambertian, without specular reflection.
    matte = False
    # Minimum over the surface.
    least_roughness = 0.0

    def _compute_textures(self) -> set[Any]:
        return super()._compute_textures() | set(self.further.values())


def _surface(material: Material) -> Surface:
    textures = textures_of(material)
    surface = Surface(
        name=material.name,
        baseColorFactor=material.base_colour_rgba,
        baseColorTexture=textures.pop("base_colour", None),
        metallicFactor=material.metallic,
        roughnessFactor=material.roughness,
        metallicRoughnessTexture=textures.pop("metallic_roughness", None),
        normalTexture=textures.pop("normal", None),
        occlusionTexture=textures.pop("occlusion", None),
        emissiveFactor=material.emission_rgb,
        emissiveTexture=textures.pop("emission", None),
        alphaMode=material.alpha_mode,
        alphaCutoff=material.alpha_cutoff,
        doubleSided=material.double_sided,
    )
    surface.layer_of = {name: image.uv_layer for name, image in material.maps.items()}
    surface.further, surface.terms = textures, material.terms
    surface.normal_scale = material.normal_scale
    surface.occlusion_strength = material.occlusion_strength
    surface.is_cut_out = is_cut_out(material)
    surface.least_roughness = _least_roughness(material)
    return surface


def _least_roughness(material: Material) -> float:
    """Minimum roughness over the surface, by the green channel of the map."""
    found = material.maps.get("metallic_roughness")
    least = 1.0 if found is None else float(found.texels[..., 1].min()) / 255.0
    return material.roughness * least


def _wound_as_normals(primitive: Any) -> bool:
    """Whether all normals lie on the anticlockwise side of their triangles."""
    if primitive.normals is None:
        return True
    # One array per coordinate, in blocks that fit the processor's cache.
    positions, normals = (
        np.ascontiguousarray(rows.T)
        for rows in (primitive.positions.astype(float), primitive.normals)
    )
    triangles = np.asarray(primitive.indices, np.int64).reshape(-1, 3)
    for first in range(0, len(triangles), _TRIANGLES_AT_A_TIME):
        corners = triangles[first : first + _TRIANGLES_AT_A_TIME].T
        start = positions[:, corners[0]]
        (ax, ay, az), (bx, by, bz) = (positions[:, end] - start for end in corners[1:])
        face = np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
        has_area = face.any(axis=0)
        for corner in corners:
            if not ((face * normals[:, corner]).sum(axis=0) > 0.0)[has_area].all():
                return False
    return True

"""A loaded scene as a pyrender scene: its meshes, materials and the ground disc."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.ground_disc import GroundDisc, triangulate
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.daylight.scene_content import MapName, Material, Mesh
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.render.colour_texture import colour_texture
from vrut_lite.render.gl_environment import import_pyrender

pyrender = import_pyrender()


@dataclass(frozen=True)
class PlacedPrimitive:
    """A pyrender primitive where it stands.

    `centre_m` (3,) is the middle of its bounds, `radius_m` holds it all from there. The matrix
    (4, 4) stays ours: pyrender would decompose it, which fails for a flattened one.
    """

    primitive: Any
    world_from_model: FloatArray
    centre_m: FloatArray
    radius_m: float
    casts_shadow: bool


class PyrenderScene:
    """Meshes whose buffers pyrender keeps, where they stand, and the paint of the ground."""

    def __init__(self, opened: SceneOpened):
        self.scene = pyrender.Scene()
        self.placed: list[PlacedPrimitive] = []
        self._known: set[int] = set()
        lower_m, upper_m = np.asarray(opened.lower_m), np.asarray(opened.upper_m)
        self.centre_m = 0.5 * (lower_m + upper_m)
        self.radius_m = max(0.5 * float(np.linalg.norm(upper_m - lower_m)), 1e-6)
        # Where the ground behind the scene lies.
        self.ground_level_m = 0.0 if opened.ground is None else opened.ground.height_m
        self._ground_material: Any = None
        geometry = opened.geometry
        surfaces = [_surface(material) for material in opened.materials.all()]
        meshes = [geometry.mesh(number) for number in range(geometry.mesh_count)]
        primitives = [_primitive(mesh, surfaces[mesh.material]) for mesh in meshes]
        places = zip(geometry.part_mesh.values, geometry.world_from_part.values, strict=True)
        for number, matrix in places:
            primitive, model_from_centred = primitives[number]
            self._place(primitive, matrix @ model_from_centred, True)
        if opened.ground is not None:
            self._add_ground(opened.ground)

    def _place(self, primitive: Any, matrix: FloatArray, casts_shadow: bool) -> None:
        if id(primitive) not in self._known:
            self._known.add(id(primitive))
            self.scene.add(pyrender.Mesh([primitive]))
        # Vertices count from the middle of their bounds, which is the matrix's translation.
        largest = float(np.linalg.norm(primitive.positions, axis=1).max(initial=0.0))
        radius_m = largest * float(np.linalg.norm(matrix[:3, :3], ord=2))
        self.placed.append(
            PlacedPrimitive(primitive, matrix, matrix[:3, 3], radius_m, casts_shadow)
        )

    def paint_ground(self, albedo_rgb: Vector) -> None:
        """Give the ground disc an albedo, linear RGB in [0, 1]."""
        if self._ground_material is not None:
            self._ground_material.baseColorFactor = [*albedo_rgb, 1.0]

    def _add_ground(self, ground: GroundDisc) -> None:
        vertices, triangles = triangulate(ground)
        # Matte, without the reflection of a dielectric: the disc then has the radiance
        # albedo * E / pi of the sky's own lower half, and its rim does not show.
        self._ground_material = Surface(
            baseColorFactor=[0.1, 0.1, 0.1, 1.0], metallicFactor=0.0, roughnessFactor=1.0
        )
        self._ground_material.matte = True
        primitive = pyrender.Primitive(
            positions=vertices,
            normals=np.tile(np.array([0, 1, 0], np.float32), (len(vertices), 1)),
            indices=triangles,
            material=self._ground_material,
        )
        middle = np.eye(4)
        middle[:3, 3] = [ground.centre_xz_m[0], ground.height_m, ground.centre_xz_m[1]]
        self._place(primitive, middle, False)


def _primitive(mesh: Mesh, surface: "Surface") -> tuple[Any, FloatArray]:
    """The primitive, its vertices centred, and the matrix (4, 4) that moves them back.

    Single precision is then spent on the mesh itself, not on where its origin happens to be.
    """
    centre = 0.5 * (mesh.positions_m.min(axis=0) + mesh.positions_m.max(axis=0))
    primitive = pyrender.Primitive(
        positions=(mesh.positions_m - centre).astype(np.float32),
        normals=np.asarray(mesh.normals, np.float32),
        texcoord_0=None if mesh.uv is None else np.asarray(mesh.uv, np.float32),
        texcoord_1=mesh.second_uv,
        color_0=mesh.colours_rgba,
        indices=np.asarray(mesh.triangles, np.uint32),
        material=surface,
    )
    model_from_centred = np.eye(4)
    model_from_centred[:3, 3] = centre
    return primitive, model_from_centred


class Surface(pyrender.MetallicRoughnessMaterial):  # type: ignore[name-defined]
    """pyrender's material, and what of ours it has no place for."""

    layer_of: Mapping[MapName, int] = MappingProxyType({})
    normal_scale = 1.0
    occlusion_strength = 1.0
    # Reflects nothing: Lambert's surface itself.
    matte = False


def _surface(material: Material) -> Surface:
    texels = {name: image.texels for name, image in material.maps.items()}
    surface = Surface(
        name=material.name,
        baseColorFactor=material.base_colour_rgba,
        baseColorTexture=colour_texture(texels.get("base_colour"), "RGBA"),
        metallicFactor=material.metallic,
        roughnessFactor=material.roughness,
        metallicRoughnessTexture=texels.get("metallic_roughness"),
        normalTexture=texels.get("normal"),
        occlusionTexture=_rgb_texture(texels.get("occlusion")),
        emissiveFactor=material.emission_rgb,
        emissiveTexture=colour_texture(texels.get("emission"), "RGB"),
        alphaMode=material.alpha_mode,
        alphaCutoff=material.alpha_cutoff,
        doubleSided=material.double_sided,
    )
    surface.layer_of = {name: image.uv_layer for name, image in material.maps.items()}
    surface.normal_scale = material.normal_scale
    surface.occlusion_strength = material.occlusion_strength
    return surface


def _rgb_texture(texels: NDArray[np.uint8] | None) -> Any:
    """All three channels: pyrender's way to one channel fails for a row or column of pixels."""
    return None if texels is None else pyrender.Texture(source=texels, source_channels="RGB")

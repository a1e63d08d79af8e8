"""A loaded scene as a pyrender scene: its meshes, materials and the ground disc."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.render.colour_texture import colour_texture
from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.scene.ground_disc import GroundDisc, triangulate
from vrut_lite.scene.loading import LoadedScene
from vrut_lite.scene.materials import SurfaceMaterial

pyrender = import_pyrender()


@dataclass(frozen=True)
class PlacedPrimitive:
    """A pyrender primitive where it stands.

    `centre_m` (3,) is the middle of its bounds, `radius_m` holds it all from there. The matrix
    (4, 4) stays ours: pyrender would decompose it, which fails for a flattened one.
    """

    primitive: Any
    world_from_model: NDArray[np.float64]
    centre_m: NDArray[np.float64]
    radius_m: float
    casts_shadow: bool


class PyrenderScene:
    """Meshes whose buffers pyrender keeps, where they stand, and the paint of the ground."""

    def __init__(self, loaded: LoadedScene, ground: GroundDisc | None):
        self.scene = pyrender.Scene()
        self.placed: list[PlacedPrimitive] = []
        self._known: set[int] = set()
        self.centre_m = 0.5 * (loaded.lower_m + loaded.upper_m)
        self.radius_m = max(0.5 * float(np.linalg.norm(loaded.upper_m - loaded.lower_m)), 1e-6)
        # Where the ground behind the scene lies.
        self.ground_level_m = 0.0 if ground is None else ground.height_m
        self._ground_material: Any = None
        shared: dict[int, tuple[Any, NDArray[np.float64]]] = {}
        for placed in loaded.meshes:
            if id(placed.mesh) not in shared:
                shared[id(placed.mesh)] = _primitive(placed.mesh)
            primitive, model_from_centred = shared[id(placed.mesh)]
            self._place(primitive, placed.world_from_model @ model_from_centred, True)
        if ground is not None:
            self._add_ground(ground)

    def _place(self, primitive: Any, matrix: NDArray[np.float64], casts_shadow: bool) -> None:
        if id(primitive) not in self._known:
            self._known.add(id(primitive))
            self.scene.add(pyrender.Mesh([primitive]))
        # Vertices count from the middle of their bounds, which is the matrix's translation.
        largest = float(np.linalg.norm(primitive.positions, axis=1).max(initial=0.0))
        radius_m = largest * float(np.linalg.norm(matrix[:3, :3], ord=2))
        self.placed.append(
            PlacedPrimitive(primitive, matrix, matrix[:3, 3], radius_m, casts_shadow)
        )

    def paint_ground(self, albedo_rgb: NDArray[np.float64]) -> None:
        """Give the ground disc an albedo (3,), linear."""
        if self._ground_material is not None:
            self._ground_material.baseColorFactor = [*np.clip(albedo_rgb, 0.0, 1.0), 1.0]

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


def _primitive(mesh: trimesh.Trimesh) -> tuple[Any, NDArray[np.float64]]:
    """The primitive, its vertices centred, and the matrix (4, 4) that moves them back.

    Single precision is then spent on the mesh itself, not on where its origin happens to be.
    """
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    centre = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    uv = getattr(mesh.visual, "uv", None)
    primitive = pyrender.Primitive(
        positions=(vertices - centre).astype(np.float32),
        normals=np.asarray(mesh.vertex_normals, np.float32),
        texcoord_0=None if uv is None else np.asarray(uv, np.float32),
        texcoord_1=mesh.vertex_attributes.get("second_uv"),
        color_0=mesh.vertex_attributes.get("color"),
        indices=np.asarray(mesh.faces, np.uint32),
        material=_material(mesh),
    )
    model_from_centred = np.eye(4)
    model_from_centred[:3, 3] = centre
    return primitive, model_from_centred


class Surface(pyrender.MetallicRoughnessMaterial):  # type: ignore[name-defined]
    """pyrender's material, and what of ours it has no place for."""

    layer_of: Mapping[str, int] = MappingProxyType({})
    normal_scale = 1.0
    occlusion_strength = 1.0
    # Reflects nothing: Lambert's surface itself.
    matte = False


def _material(mesh: trimesh.Trimesh) -> Surface:
    source: SurfaceMaterial = mesh.visual.material  # type: ignore[union-attr]
    surface = Surface(
        name=source.name,
        baseColorFactor=source.baseColorFactor,
        baseColorTexture=colour_texture(source.baseColorTexture, "RGBA"),
        metallicFactor=source.metallicFactor,
        roughnessFactor=source.roughnessFactor,
        metallicRoughnessTexture=source.metallicRoughnessTexture,
        normalTexture=source.normalTexture,
        occlusionTexture=_rgb_texture(source.occlusionTexture),
        emissiveFactor=source.emissiveFactor,
        emissiveTexture=colour_texture(source.emissiveTexture, "RGB"),
        alphaMode=source.alphaMode,
        alphaCutoff=source.alphaCutoff,
        doubleSided=bool(source.doubleSided),
    )
    surface.layer_of = source.layer_of
    surface.normal_scale = source.normal_scale
    surface.occlusion_strength = source.occlusion_strength
    return surface


def _rgb_texture(image: Image.Image | None) -> Any:
    """All three channels: pyrender's way to one channel fails for a row or column of pixels."""
    return None if image is None else pyrender.Texture(source=image, source_channels="RGB")

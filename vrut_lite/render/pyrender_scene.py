"""A loaded scene as a pyrender scene: its meshes, materials and the ground disc."""

from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.scene.ground_disc import GroundDisc, triangulate
from vrut_lite.scene.loading import LoadedScene
from vrut_lite.scene.materials import SurfaceMaterial

pyrender = import_pyrender()


class PyrenderScene:
    """A pyrender scene, which of its nodes cast shadows, and the paint of its ground."""

    def __init__(self, loaded: LoadedScene, ground: GroundDisc | None):
        self.scene = pyrender.Scene()
        self.casters: set[Any] = set()
        self.centre_m = 0.5 * (loaded.lower_m + loaded.upper_m)
        self.radius_m = max(0.5 * float(np.linalg.norm(loaded.upper_m - loaded.lower_m)), 1e-6)
        self.ground = ground
        self._ground_material: Any = None
        shared: dict[int, Any] = {}
        for placed in loaded.meshes:
            if id(placed.mesh) not in shared:
                shared[id(placed.mesh)] = pyrender.Mesh([_primitive(placed.mesh)])
            node = self.scene.add(shared[id(placed.mesh)], pose=placed.world_from_model)
            self.casters.add(node)
        if ground is not None:
            self._add_ground(ground)

    def paint_ground(self, albedo_rgb: NDArray[np.float64]) -> None:
        """Give the ground disc an albedo (3,), linear."""
        if self._ground_material is not None:
            self._ground_material.baseColorFactor = [*np.clip(albedo_rgb, 0.0, 1.0), 1.0]

    def _add_ground(self, ground: GroundDisc) -> None:
        vertices, triangles = triangulate(ground)
        # Matte, without the reflection of a dielectric: the disc then has the radiance
        # albedo * E / pi of the sky's own lower half, and its rim does not show.
        self._ground_material = pyrender.MetallicRoughnessMaterial(
            baseColorFactor=[0.1, 0.1, 0.1, 1.0], metallicFactor=0.0, roughnessFactor=1.0
        )
        self._ground_material.matte = True
        primitive = pyrender.Primitive(
            positions=vertices,
            normals=np.tile(np.array([0, 1, 0], np.float32), (len(vertices), 1)),
            indices=triangles,
            material=self._ground_material,
        )
        self.scene.add(pyrender.Mesh([primitive], name="ground"))


def _primitive(mesh: trimesh.Trimesh) -> Any:
    uv = getattr(mesh.visual, "uv", None)
    return pyrender.Primitive(
        positions=np.asarray(mesh.vertices, np.float32),
        normals=np.asarray(mesh.vertex_normals, np.float32),
        texcoord_0=None if uv is None else np.asarray(uv, np.float32),
        color_0=mesh.vertex_attributes.get("color"),
        indices=np.asarray(mesh.faces, np.uint32),
        material=_material(mesh),
    )


def _material(mesh: trimesh.Trimesh) -> Any:
    source: SurfaceMaterial = mesh.visual.material  # type: ignore[union-attr]
    return pyrender.MetallicRoughnessMaterial(
        name=source.name,
        baseColorFactor=source.baseColorFactor,
        baseColorTexture=source.baseColorTexture,
        metallicFactor=source.metallicFactor,
        roughnessFactor=source.roughnessFactor,
        metallicRoughnessTexture=source.metallicRoughnessTexture,
        normalTexture=source.normalTexture,
        occlusionTexture=source.occlusionTexture,
        emissiveFactor=source.emissiveFactor,
        emissiveTexture=source.emissiveTexture,
        alphaMode=source.alphaMode,
        alphaCutoff=source.alphaCutoff,
        doubleSided=bool(source.doubleSided),
    )

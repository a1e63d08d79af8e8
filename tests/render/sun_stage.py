"""Grey things under the sun alone, for tests of its shadows."""

import numpy as np
import trimesh
from scene_stage import light
from stateful_backend import opened

RADIUS_RAD, IRRADIANCE, GREY = 0.00465, 10.0, 0.4
SUN = np.array([0.45, 0.8, -0.2]) / np.linalg.norm([0.45, 0.8, -0.2])
BLACK = np.zeros((6, 8, 8, 3))


def show(backend, folder, *meshes, sun=SUN):
    """Grey, rough things under the sun alone."""
    grey = trimesh.visual.material.PBRMaterial(
        baseColorFactor=(GREY, GREY, GREY, 1.0), metallicFactor=0.0, roughnessFactor=1.0
    )
    for mesh in meshes:
        mesh.visual = trimesh.visual.TextureVisuals(material=grey)
    path = folder / "scene.glb"
    trimesh.Scene(meshes).export(path)
    backend.change(scene=opened(path))
    light(backend, BLACK, sun_direction=tuple(sun), sun_irradiance=(IRRADIANCE,) * 3)


def box(lower, upper):
    """A box between two corners."""
    lower, upper = np.array(lower, float), np.array(upper, float)
    return trimesh.creation.box(upper - lower).apply_translation(0.5 * (lower + upper))

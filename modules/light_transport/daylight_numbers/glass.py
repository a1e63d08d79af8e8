"""Which triangles are glass, and how much light passes them at each angle.

A pane passes its colour times what its two faces do not reflect, at any angle by Fresnel, with all
that bounces between them. Of a body each side passes the root of its colour. Nothing is bent.
"""

from typing import NamedTuple

import numpy as np

from light_transport.surfaces.surfaces import Surfaces
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.numeric_types import BoolArray, Float32Array

_LEAST_IOR = 1.0001


class Glass(NamedTuple):
    """Triangles (F) of a scene as glass.

    `tint` (F, 3) float32: what is left by colour at any angle, 0 where nothing passes; `ior` (F,)
    float32; `is_pane` (F,) bool.
    """

    tint: Float32Array
    ior: Float32Array
    is_pane: BoolArray

    @property
    def clear(self) -> BoolArray:
        """Which triangles (F,) pass light."""
        return np.asarray(self.tint.any(axis=1))


def no_glass(triangles: int) -> Glass:
    """Nothing but opaque triangles."""
    return Glass(
        np.zeros((triangles, 3), np.float32),
        np.full(triangles, 1.5, np.float32),
        np.ones(triangles, bool),
    )


def glass_of(scene: SceneOpened, surfaces: Surfaces) -> Glass:
    """The glass of a scene, by KHR_materials_transmission; maps of colour are not looked up."""
    found = no_glass(len(surfaces.part))
    materials = scene.materials.all()
    for part, mesh in enumerate(scene.geometry.part_mesh.values.tolist()):
        material = materials[scene.geometry.mesh(mesh).material]
        terms = material.terms
        if not terms.transmits:
            continue
        here = surfaces.part == part
        left = np.asarray(material.base_colour_rgba[:3], float)
        if not terms.is_pane:
            left = np.sqrt(left * np.exp(-np.asarray(terms.extinction_per_m) * terms.thickness_m))
        found.tint[here] = terms.transmission * (1.0 - material.metallic) * left
        found.ior[here] = max(terms.ior, _LEAST_IOR)
        found.is_pane[here] = terms.is_pane
    return found

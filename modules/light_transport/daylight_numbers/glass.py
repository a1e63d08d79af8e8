"""Which triangles are glass, and how much light passes them at each angle.

Panes pass their colour times what their faces do not reflect, at any angle by Fresnel, with all
that bounces between them. Of a body each side passes the root of its colour. Nothing is bent.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.surfaces.surfaces import Surfaces
from vrut_lite.daylight.glazing import IOR as _IOR
from vrut_lite.daylight.glazing import Glazing, clear_at_right_angles
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

_LEAST_IOR = 1.0001


class Glass(NamedTuple):
    """Triangles (F) of a scene as glass.

    `tint` (F, 3) float32: what is left by colour at any angle, 0 where nothing passes; `ior` (F,)
    float32; `panes` (F,) int32, how many stand behind each other; 0 for a side of a body.
    """

    tint: Float32Array
    ior: Float32Array
    panes: NDArray[np.int32]

    @property
    def clear(self) -> BoolArray:
        """Which triangles (F,) pass light."""
        return np.asarray(self.tint.any(axis=1))


def no_glass(triangles: int) -> Glass:
    """Nothing but opaque triangles."""
    return Glass(
        np.zeros((triangles, 3), np.float32),
        np.full(triangles, 1.5, np.float32),
        np.ones(triangles, np.int32),
    )


def glass_of(
    scene: SceneOpened, surfaces: Surfaces, glazing: Mapping[str, Glazing] | None = None
) -> Glass:
    """The glass of a scene, by KHR_materials_transmission; maps of colour are not looked up.

    Materials in `glazing` have what it says of them.

    Raises:
        UserError: a name of `glazing` is that of no material.
    """
    found = no_glass(len(surfaces.part))
    materials, told = scene.materials.all(), glazing or {}
    unknown = sorted(set(told) - {material.name for material in materials})
    if unknown:
        names = ", ".join(sorted({material.name for material in materials}))
        raise UserError(f"glazing: the scene has no material '{unknown[0]}'; it has {names}")
    for part, mesh in enumerate(scene.geometry.part_mesh.values.tolist()):
        material = materials[scene.geometry.mesh(mesh).material]
        terms = material.terms
        here = surfaces.part == part
        if material.name in told:
            glass = told[material.name]
            found.ior[here], found.panes[here] = _IOR, glass.panes
            share = glass.transmittance / clear_at_right_angles(glass.panes)
            found.tint[here] = share * np.asarray(glass.colour)
            continue
        if not terms.transmits:
            continue
        left = np.asarray(material.base_colour_rgba[:3], float)
        if not terms.is_pane:
            left = np.sqrt(left * np.exp(-np.asarray(terms.extinction_per_m) * terms.thickness_m))
        found.tint[here] = terms.transmission * (1.0 - material.metallic) * left
        found.ior[here] = max(terms.ior, _LEAST_IOR)
        found.panes[here] = int(terms.is_pane)
    return found


def with_glazing(surfaces: Surfaces, glass: Glass, glazed: BoolArray) -> Surfaces:
    """Surfaces whose `glazed` triangles (F,) let as much of diffuse light pass as their glass."""
    if not glazed.any():
        return surfaces
    passing, back = np.zeros((2, len(glazed)))
    for panes in np.unique(glass.panes[glazed]):
        here = glazed & (glass.panes == panes)
        passing[here] = luminance(glass.tint[here].astype(float)) * diffuse_share(int(panes))
        back[here] = 1.0 - diffuse_share(int(panes))
    passing = np.minimum(passing, 1.0)
    reflectance = np.minimum(back / np.maximum(1.0 - passing, 1e-3), 1.0)
    return replace(
        surfaces,
        opacity=np.where(glazed, 1.0 - passing, surfaces.opacity).astype(np.float32),
        reflectance_rgb=np.where(
            glazed[:, None], reflectance[:, None], surfaces.reflectance_rgb
        ).astype(np.float32),
    )


@lru_cache(maxsize=8)
def diffuse_share(panes: int) -> float:
    """What clear panes let through of light from all sides of a hemisphere."""
    cosine = (np.arange(512) + 0.5) / 512
    return float(2.0 * np.mean(clear_share(cosine, panes) * cosine))


def clear_share(cosine: FloatArray, panes: int) -> FloatArray:
    """What clear panes let through at angles with these cosines.

    Of p panes, 2 p faces that each reflect r: (1 - r) / (1 + (2 p - 1) r) (Stokes 1862).
    """
    bent = np.sqrt(1.0 - (1.0 - cosine**2) / _IOR**2)
    across = ((cosine - _IOR * bent) / (cosine + _IOR * bent)) ** 2
    along = ((_IOR * cosine - bent) / (_IOR * cosine + bent)) ** 2
    more = 2 * panes - 1
    return np.asarray(0.5 * ((1 - across) / (1 + more * across) + (1 - along) / (1 + more * along)))

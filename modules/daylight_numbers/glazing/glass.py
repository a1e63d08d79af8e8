"""Which triangles are glass, and how much light passes them at each angle.

Panes take light away at each way through their glass, by Beer's law along the bent way, and send it
back at each face, by Fresnel; all that bounces in and between them counts, for each polarisation
(Stokes 1862). Of a body each side passes the root of its colour. Nothing is displaced.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from light_transport.public import Surfaces
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import luminance
from vrut_lite.messages.glazing import IOR as _IOR
from vrut_lite.messages.glazing import Glazing
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

_LEAST_IOR = 1.0001
# Angles of a hemisphere, and steps by which a tint is found.
_ANGLES, _HALVINGS = 512, 50


class Glass(NamedTuple):
    """Triangles (F) of a scene as glass.

    `tint` (F, 3) float32, 0 where nothing passes: what the glass of each pane leaves of light by
    colour on the shortest way through it, or, above 1, what panes pass more than clear ones; of a
    body what each side leaves at any angle. `ior` (F,) float32; `panes` (F,) int32, how many stand
    behind each other; 0 for a side of a body.
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
            told_rgb = glass.transmittance * np.asarray(glass.colour)
            found.tint[here] = tint_of(told_rgb, glass.panes)
            continue
        if not terms.transmits:
            continue
        left = np.asarray(material.base_colour_rgba[:3], float)
        if not terms.is_pane:
            left = np.sqrt(left * np.exp(-np.asarray(terms.extinction_per_m) * terms.thickness_m))
        left = terms.transmission * (1.0 - material.metallic) * left
        ior = max(terms.ior, _LEAST_IOR)
        if terms.is_pane:
            left = tint_of(left * stack(1.0, 1.0, 1, ior)[0], 1, ior)
        found.tint[here], found.ior[here] = left, ior
        found.panes[here] = int(terms.is_pane)
    return found


def with_glazing(surfaces: Surfaces, glass: Glass, glazed: BoolArray) -> Surfaces:
    """Surfaces whose `glazed` triangles (F,) let as much of diffuse light pass as their glass."""
    if not glazed.any():
        return surfaces
    passing, back = np.zeros((2, len(glazed)))
    kinds, which = np.unique(
        np.column_stack([glass.tint[glazed], glass.panes[glazed]]), axis=0, return_inverse=True
    )
    shares = np.array([diffuse_shares(kind[:3], int(kind[3])) for kind in kinds])
    passing[glazed], back[glazed] = np.minimum(shares[which.ravel()], 1.0).T
    reflectance = np.minimum(back / np.maximum(1.0 - passing, 1e-3), 1.0)
    return replace(
        surfaces,
        opacity=np.where(glazed, 1.0 - passing, surfaces.opacity).astype(np.float32),
        reflectance_rgb=np.where(
            glazed[:, None], reflectance[:, None], surfaces.reflectance_rgb
        ).astype(np.float32),
    )


def diffuse_shares(tint_rgb: FloatArray, panes: int) -> tuple[float, float]:
    """Luminance that panes let through, and that they send back, of even light on one side."""
    cosine = (np.arange(_ANGLES) + 0.5)[:, None] / _ANGLES
    passed, back = (2.0 * np.mean(part * cosine, axis=0) for part in stack(cosine, tint_rgb, panes))
    return float(luminance(passed)), float(luminance(back))


def tint_of(passed: FloatArray, panes: int, ior: float = _IOR) -> FloatArray:
    """The tint of panes that let `passed` (...) through at right angles, by halving."""
    clear = stack(1.0, 1.0, panes, ior)[0]
    low, high = np.zeros_like(passed), np.ones_like(passed)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        is_more = stack(1.0, middle, panes, ior)[0] > passed
        low, high = np.where(is_more, low, middle), np.where(is_more, middle, high)
    return np.where(passed < clear, high * (passed > 0.0), passed / clear)


def stack(
    cosine: FloatArray | float, tint: FloatArray | float, panes: int, ior: float = _IOR
) -> tuple[FloatArray, FloatArray]:
    """Transmittance and reflectance of panes for unpolarised light at angles with these cosines.

    A pane whose glass leaves t on one way through, each of whose faces reflects r, passes
    T = (1 - r)^2 t / (1 - r^2 t^2) and sends back R = r (1 + t T); panes are added one by one.
    """
    bent = np.sqrt(1.0 - (1.0 - np.square(cosine)) / ior**2)
    across = ((cosine - ior * bent) / (cosine + ior * bent)) ** 2
    along = ((ior * cosine - bent) / (ior * cosine + bent)) ** 2
    inner, more = np.minimum(tint, 1.0) ** (1.0 / bent), np.maximum(tint, 1.0)
    passed, sent = np.zeros((2, *np.shape(across * inner)))
    for face in (across, along):
        passes = (1.0 - face) ** 2 * inner / (1.0 - (face * inner) ** 2)
        back = face * (1.0 + inner * passes)
        through, returned = passes, back
        for _ in range(1, panes):
            between = 1.0 / (1.0 - returned * back)
            returned = returned + through**2 * back * between
            through = through * passes * between
        passed, sent = passed + 0.5 * through, sent + 0.5 * returned
    return np.asarray(more * passed), np.asarray(sent)

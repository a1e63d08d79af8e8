"""Reflectances, emission and glass of a scene by wavelength, from colours or measured spectra."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from light_transport.public import SceneTransport, surfaces_of

from daylight_numbers.glazing.glass import Glass, tint_of
from daylight_numbers.spectra.daylight import daylight_of_rgb
from daylight_numbers.spectra.reflectances import reflectances_of
from daylight_numbers.spectra.spectra_file import MaterialSpectra
from daylight_numbers.spectra.spectral_sky import WAVELENGTHS_NM
from vrut_lite.errors import UserError
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import BoolArray, FloatArray, IntArray

# Glass that passes nothing of a wavelength is still glass: rays go on behind it.
_LEAST_TINT = 1e-6


class Bands(NamedTuple):
    """Three wavelengths, which are computed at once as red, green and blue are: their numbers (3,),
    the last repeated where fewer are left, and how many count."""

    columns: IntArray
    wanted: int

    @property
    def own(self) -> IntArray:
        """Numbers of those that are wanted."""
        return self.columns[: self.wanted]


def bands(wanted: IntArray) -> Iterator[Bands]:
    """Some wavelengths by their numbers, three by three."""
    for first in range(0, len(wanted), 3):
        columns = wanted[first : first + 3]
        yield Bands(np.pad(columns, (0, 3 - len(columns)), "edge"), len(columns))


class SpectralSurfaces(NamedTuple):
    """Surfaces at `WAVELENGTHS_NM` (W).

    `reflectance` (M, W) and `emitted` (M, W), W m^-2 nm^-1, of patches; the ground's reflectance
    comes with the hour. `tints` (K, W) of glass, and the tint of each triangle (F,), -1 for none;
    `glass_is_own`: whether these differ from wavelength to wavelength, or from the scene's.
    """

    reflectance: FloatArray
    emitted: FloatArray
    tints: FloatArray
    tint_of_triangle: IntArray
    glass_is_own: bool

    def glass(self, clear: Glass, at: Bands) -> Glass:
        """Glass whose three colours are three wavelengths."""
        tint = np.zeros_like(clear.tint)
        is_glass = self.tint_of_triangle >= 0
        tints = np.maximum(self.tints[self.tint_of_triangle[is_glass]], _LEAST_TINT)
        tint[is_glass] = tints[:, at.columns]
        return clear._replace(tint=tint)


def spectral_surfaces(
    scene: SceneOpened, transport: SceneTransport, glass: Glass, measured: MaterialSpectra
) -> SpectralSurfaces:
    """The surfaces of a scene, whose materials have measured spectra by their names, or else the
    smooth spectrum of their colour.

    Raises:
        UserError: no material has a measured name.
    """
    assert transport.patches is not None
    materials = [material.name for material in scene.materials.all()]
    if unknown := sorted(set(measured.shares) - set(materials)):
        names = ", ".join(sorted(set(materials)))
        raise UserError(
            f"{measured.file}: the scene has no material '{unknown[0]}'; it has {names}"
        )
    surfaces = surfaces_of(scene)
    material_of_part = np.array(
        [scene.geometry.mesh(mesh).material for mesh in scene.geometry.part_mesh.values.tolist()]
    )
    of_triangle = np.append(material_of_part, -1)[surfaces.part]
    patches = transport.patches
    reflectance = reflectances_of(
        np.clip(patches.reflectance_rgb.astype(float), 0.0, 1.0), WAVELENGTHS_NM
    )
    of_patch = of_triangle[_triangle_of_patch(transport)]
    for name in measured.shares:
        here = np.isin(of_patch, [n for n, other in enumerate(materials) if other == name])
        reflectance[here] = measured.at(name, WAVELENGTHS_NM)
    emitted = daylight_of_rgb(patches.emitted_rgb, WAVELENGTHS_NM)
    measured_numbers = [n for n, name in enumerate(materials) if name in measured.shares]
    tints, which = _tints(glass, of_triangle, measured_numbers, materials, measured)
    is_own = bool(np.any(np.ptp(tints, axis=1) > 0.0)) or bool(
        np.isin(of_triangle[glass.clear], measured_numbers).any()
    )
    return SpectralSurfaces(reflectance, emitted, tints, which, is_own)


def _triangle_of_patch(transport: SceneTransport) -> IntArray:
    """A triangle (M,) of each patch, whose rows are all of one part."""
    assert transport.patches is not None
    receivers, patches = transport.receivers, transport.patches
    row = patches.member[patches.start[:-1]].astype(np.int64)
    texels = len(receivers.texels.pixel)
    first_group = texels + len(receivers.probes.place)
    found = np.zeros(len(row), np.int64)
    is_texel = row < texels
    found[is_texel] = receivers.texels.triangle[row[is_texel]]
    groups = receivers.groups
    found[~is_texel] = groups.triangle[groups.start[row[~is_texel] - first_group]]
    return found


def _tints(
    glass: Glass,
    of_triangle: IntArray,
    measured_numbers: list[int],
    materials: list[str],
    measured: MaterialSpectra,
) -> tuple[FloatArray, IntArray]:
    """Spectra (K, W) of tints, and their numbers by triangle (F,)."""
    clear: BoolArray = glass.clear
    which = np.full(len(clear), -1)
    if not clear.any():
        return np.zeros((0, len(WAVELENGTHS_NM))), which
    is_measured = np.isin(of_triangle, measured_numbers)
    keys = np.column_stack(
        [glass.tint, glass.ior, glass.panes, np.where(is_measured, of_triangle, -1)]
    )[clear]
    kinds, numbers = np.unique(keys, axis=0, return_inverse=True)
    which[clear] = numbers.ravel()
    return np.stack([_tint(kind, materials, measured) for kind in kinds]), which


def _tint(kind: FloatArray, materials: list[str], measured: MaterialSpectra) -> FloatArray:
    """The tint (W,) of glass with a colour, index of refraction, panes and material."""
    rgb, ior, panes, material = kind[:3], float(kind[3]), int(kind[4]), int(kind[5])
    if material >= 0:
        passed = measured.at(materials[material], WAVELENGTHS_NM)
        # A body passes its colour by two sides.
        return tint_of(passed, panes, ior) if panes else np.sqrt(passed)
    most = max(float(rgb.max()), 1.0)
    return most * reflectances_of([rgb / most], WAVELENGTHS_NM)[0]

"""An atmosphere as the solver's kernels take it: four wavelengths at a time.

Wavelengths do not mix, and four float32 numbers fill a SIMD register: so all kernels work on
groups of four wavelengths, the last group padded with wavelengths of no light and no matter.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.optical_path import TENT

LANES = 4
# Reach of a dense layer in scale heights, and its share of an axis of altitudes.
FOG_REACH, FOG_SHARE = 3.0, 0.4
HAZE_REACH, HAZE_SHARE = 1.0, 0.4
# Optical depths from which on aerosol counts as haze, and as thick haze: at 445 nm turbidity 2 has
# 0.13, turbidity 4 0.4.
_HAZE, _THICK_HAZE = 0.1, 0.4
# Optical depth of the stratosphere's aerosol beyond which its edges need finer rays in twilight.
_VEIL = 0.01


class WavelengthGroup(NamedTuple):
    """Four wavelengths of an atmosphere, SI units.

    `extinction` (6, 4): of molecules, aerosol, absorber, fog, aerosol aloft and of the
    stratosphere; `scattering` (5, 4): of molecules, aerosol, aerosol aloft, fog, aerosol of the
    stratosphere; `anisotropy`: of molecules, see `Atmosphere.rayleigh_anisotropy`; `molecules` (2,
    n): shares and scale heights of the exponentials of their density; `absorber`, `stratosphere`
    (2, n): altitudes and relative densities of their nodes; one node makes no layer, where there is
    no such matter. `aloft_scale_height_m` and `fog_scale_height_m` are 0 without such a layer.
    `layer_reach_m`, `layer_share`: see `ray_kernels`; a share of 0 is no layer.
    """

    ground_radius_m: float
    top_altitude_m: float
    mie_scale_height_m: float
    aloft_scale_height_m: float
    fog_scale_height_m: float
    layer_reach_m: float
    layer_share: float
    anisotropy: float
    extinction: NDArray[np.float64]
    scattering: NDArray[np.float64]
    molecules: NDArray[np.float64]
    absorber: NDArray[np.float64]
    stratosphere: NDArray[np.float64]
    solar_irradiance: NDArray[np.float64]
    ground_albedo: NDArray[np.float64]


def groups_of_air(atmosphere: Atmosphere) -> list[WavelengthGroup]:
    """The atmosphere in groups of four wavelengths."""
    extinction = _in_fours(
        [
            atmosphere.molecule_extinction,
            atmosphere.mie_extinction,
            atmosphere.absorption_extinction,
            atmosphere.fog_extinction,
            atmosphere.aloft_extinction,
            atmosphere.stratosphere_extinction,
        ]
    )
    scattering = _in_fours(
        [
            atmosphere.rayleigh_scattering,
            atmosphere.mie_scattering,
            atmosphere.aloft_scattering,
            atmosphere.fog_scattering,
            atmosphere.stratosphere_scattering,
        ]
    )
    sun_and_ground = _in_fours([atmosphere.solar_irradiance, atmosphere.ground_albedo])
    molecules = atmosphere.molecule_layers.array()
    layers = np.array([atmosphere.absorber_altitude_m, atmosphere.absorber_density])
    tents = [(kind.kinks_m, TENT) for kind in atmosphere.particles() if kind.peak_m is not None]
    tent = np.array(tents[0] if tents else ((0.0,), (0.0,)))
    return [
        WavelengthGroup(
            atmosphere.ground_radius_m,
            atmosphere.top_altitude_m,
            atmosphere.mie_scale_height_m,
            atmosphere.aloft_scale_height_m if atmosphere.has_aloft else 0.0,
            atmosphere.fog_scale_height_m if atmosphere.foggy else 0.0,
            *dense_layer(atmosphere),
            atmosphere.rayleigh_anisotropy,
            extinction[group],
            scattering[group],
            molecules,
            layers if extinction[group, 2].any() else layers[:, :1].copy(),
            tent,
            sun_and_ground[group, 0],
            sun_and_ground[group, 1],
        )
        for group in range(len(extinction))
    ]


def is_hazy(atmosphere: Atmosphere) -> bool:
    """Whether the aerosol alone dims a sun in the zenith by a tenth at any wavelength."""
    return _aerosol_depth(atmosphere) >= _HAZE


def is_thick_haze(atmosphere: Atmosphere) -> bool:
    """Whether the aerosol dims it by a third: then orders of scattering fall off slowly."""
    return _aerosol_depth(atmosphere) >= _THICK_HAZE


def is_veiled(atmosphere: Atmosphere) -> bool:
    """Whether the stratosphere has more aerosol than its background, as after an eruption."""
    peak = max(atmosphere.stratosphere_extinction)
    return peak * atmosphere.stratosphere_half_width_m > _VEIL


def _aerosol_depth(atmosphere: Atmosphere) -> float:
    return float(atmosphere.aerosol_depth().max())


def dense_layer(atmosphere: Atmosphere) -> tuple[float, float]:
    """Reach in m of the layer of dense air, and its share of an axis of altitudes."""
    if atmosphere.foggy:
        return FOG_REACH * atmosphere.fog_scale_height_m, FOG_SHARE
    if is_hazy(atmosphere):
        return HAZE_REACH * atmosphere.mie_scale_height_m, HAZE_SHARE
    return atmosphere.top_altitude_m, 0.0


def wavelengths_of_groups(groups: ArrayLike, count: int) -> NDArray[np.float64]:
    """(groups, ..., 4) as (..., count): the padding is dropped."""
    array = np.moveaxis(np.asarray(groups), 0, -2)
    return np.ascontiguousarray(array.reshape(*array.shape[:-2], -1)[..., :count], dtype=float)


def in_lanes(values: ArrayLike) -> NDArray[np.float64]:
    """(..., C) as (groups, ..., 4), padded with zeros."""
    array = np.asarray(values, dtype=float)
    padded = np.pad(array, [*[(0, 0)] * (array.ndim - 1), (0, -array.shape[-1] % LANES)])
    split = padded.reshape(*array.shape[:-1], -1, LANES)
    return np.ascontiguousarray(np.moveaxis(split, -2, 0))


def _in_fours(rows: Sequence[ArrayLike]) -> NDArray[np.float64]:
    """(groups, rows, 4) of rows (rows, wavelengths)."""
    values = np.array(rows, dtype=float)
    padding = -values.shape[1] % LANES
    padded = np.pad(values, ((0, 0), (0, padding)))
    return np.ascontiguousarray(padded.reshape(len(rows), -1, LANES).transpose(1, 0, 2))

"""The airs that are compared: the product's, and the same conditions with independent optics."""

from collections.abc import Mapping
from dataclasses import replace

import msgspec
import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_at

from vrut_lite.atmosphere.aerosols import PhaseTable
from vrut_lite.atmosphere.exponential_layers import ExponentialLayers
from vrut_lite.geometry.colour import SKYLIGHT_NM
from vrut_lite.messages.haze import DEFAULT_HAZE, SetHaze
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.polarised_truth.gases import (
    depolarisation,
    ozone_depth,
    rayleigh_depth,
    standard_density,
)
from vrut_lite_lab.polarised_truth.particles import mixture

_OZONE_DU = 300.0
# Half width (nm) of the triangle over which ozone is averaged: the product's values are means of
# 10 nm, linear between their middles, since each of its wavelengths stands for a band.
_BAND_NM = 10.0
# Altitudes (km) at which the density is the standard atmosphere's; it is exponential between them,
# which errs by 0.2 % to 11 km and 0.8 % above.
_PROFILE_KM = (0, 1, 2, 4, 6, 8, 9.5, 11, 15, 20, 26, 32, 37, 42, 47, 51, 58, 65, 72, 78, 84)
# Particles per cm^3 of OPAC's types, table 4, and of its free troposphere.
_TYPES: Mapping[str, Mapping[str, float]] = {
    "continental-average": {"waso80": 7000.0, "inso": 0.4, "soot": 8300.0},
    "desert": {"waso80": 2000.0, "minm": 269.5, "miam": 30.5, "micm": 0.142},
}
_ALOFT = {"waso50": 438.0, "inso": 0.0013, "soot": 294.0}
_STRATOSPHERE = {"acid": 1.0}
HAZES: Mapping[str, SetHaze] = {
    "default": DEFAULT_HAZE,
    "clear": msgspec.structs.replace(
        DEFAULT_HAZE, optical_depth_550=0.0, stratosphere_depth_550=0.0
    ),
    "desert": msgspec.structs.replace(DEFAULT_HAZE, aerosol="desert", optical_depth_550=0.3),
}


def product_air(name: str) -> Atmosphere:
    """The air that the product solves, by one of HAZES."""
    return atmosphere_at(SKYLIGHT_NM, BrunetonSkySettings(), 0.0, HAZES[name])


def independent_air(name: str) -> Atmosphere:
    """The same conditions with independent optics, at a pressure of 1013.25 hPa.

    Conditions are the planet, the ground, the aerosol's layers and their depth at 550 nm, and the
    form of the ozone layer of 300 DU. Nitrogen dioxide and pairs of oxygen molecules, which take
    0.1 and 0.4 % of the light, stay the product's: their wavelengths stand for bands.
    """
    air = product_air(name)
    nm = np.asarray(SKYLIGHT_NM)
    ozone_m = np.trapezoid(air.absorber_density, air.absorber_altitude_m)
    layers = _standard_layers()
    molecules_m = layers.column_m(air.top_altitude_m)
    changed = replace(
        air,
        rayleigh_scattering=tuple(rayleigh_depth(nm) / molecules_m),
        rayleigh_scale_height_m=layers.scale_height_m[0],
        rayleigh_above_m=layers.base_m[1:],
        rayleigh_above_scale_height_m=layers.scale_height_m[1:],
        rayleigh_depolarisation=float(depolarisation(nm).mean()),
        gas_absorption=tuple(np.array(air.gas_absorption) * air.column_m / molecules_m),
        absorption_extinction=tuple(_band_ozone_depth(nm) / ozone_m),
    )
    if air.aerosol_depth().any():
        low = _layer(_TYPES[HAZES[name].aerosol], _at_550(name, "mie"))
        aloft = _layer(_ALOFT, _at_550(name, "aloft"))
        high = _layer(_STRATOSPHERE, _at_550(name, "stratosphere"))
        changed = replace(
            changed,
            mie_extinction=low[0], mie_scattering=low[1], mie_table=low[2],
            aloft_extinction=aloft[0], aloft_scattering=aloft[1], aloft_table=aloft[2],
            stratosphere_extinction=high[0], stratosphere_scattering=high[1],
            stratosphere_table=high[2],
        )  # fmt: skip
    return changed


def _band_ozone_depth(wavelength_nm: FloatArray) -> FloatArray:
    """Vertical optical depth (C,) of ozone in bands about the wavelengths."""
    offset_nm = np.linspace(-_BAND_NM, _BAND_NM, 81)
    weight = 1.0 - np.abs(offset_nm) / _BAND_NM
    depth = ozone_depth(wavelength_nm[:, None] + offset_nm, _OZONE_DU)
    return np.asarray(depth @ weight / weight.sum())


def _at_550(name: str, layer: str) -> float:
    """Extinction (1/m) on the ground of a layer of the product's air at 550 nm."""
    air = atmosphere_at((550.0,), BrunetonSkySettings(), 0.0, HAZES[name])
    return float(getattr(air, f"{layer}_extinction")[0])


def _layer(
    particles: Mapping[str, float], extinction_550: float
) -> tuple[tuple[float, ...], tuple[float, ...], PhaseTable]:
    """Extinction and scattering (C,) in 1/m on the ground, and the scattering matrix."""
    found = mixture(particles, np.array([*SKYLIGHT_NM, 550.0]))
    scale = extinction_550 / found.extinction[-1]
    p11, p12, p33 = found.matrix[:, :-1]
    table = PhaseTable.of_angles(found.angle_rad, p11, [p12 / p11, p33 / p11])
    extinction, scattering = scale * found.extinction[:-1], scale * found.scattering[:-1]
    return tuple(extinction), tuple(scattering), table


def rayleigh_layer(depth: float, albedo: float, depolarisation: float = 0.0) -> Atmosphere:
    """Molecules alone on a planet a hundred times as large as Earth.

    Its sky is that of a flat layer to 1e-3 down to 6 degrees of elevation, to 1e-4 from 20 on.
    """
    earth = Atmosphere.earth(ozone=False)
    height_m = earth.rayleigh_scale_height_m
    column_m = -height_m * np.expm1(-earth.top_altitude_m / height_m)
    return replace(
        earth,
        wavelength_nm=(550.0,),
        solar_irradiance=(1.0,),
        ground_radius_m=6.36e8,
        rayleigh_scattering=(depth / column_m,),
        rayleigh_depolarisation=depolarisation,
        mie_scattering=(0.0,),
        mie_extinction=(0.0,),
        absorption_extinction=(0.0,),
        ground_albedo=(albedo,),
    )


def _standard_layers() -> ExponentialLayers:
    """The standard atmosphere's density; the last scale height goes on above it."""
    altitude_m = 1000.0 * np.array(_PROFILE_KM)
    heights_m = -np.diff(altitude_m) / np.diff(np.log(standard_density(altitude_m)))
    above = zip(altitude_m[1:-1].tolist(), heights_m[1:].tolist(), strict=True)
    return ExponentialLayers.of(float(heights_m[0]), tuple(above))

"""Sunlight behind a cloudless air, in closed form at 95 wavelengths.

The air is that of Bruneton's 2017 demonstration with the given haze: molecules, 300 Dobson
units of ozone, aerosol. Slant paths are those of exponential layers on a sphere, by the leading
term of Chapman's function: sqrt(pi x / 2) erfcx(sqrt(x / 2) sin h) with x the planet's radius in
scale heights.
"""

import math
from functools import lru_cache

import numpy as np

from vrut_lite.atmosphere.clear_air import (
    OZONE_HALF_WIDTH_M,
    OZONE_MIDDLE_M,
    SCALE_HEIGHT_M,
    molecules_per_m,
    ozone_density,
    ozone_per_m,
)
from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.geometry.colour import colour_table, rgb_from_spectrum, solar_irradiance
from vrut_lite.messages.haze import SetHaze
from vrut_lite.numeric_types import FloatArray

# From here the series of `_erfcx` is as exact as its closed form.
_LARGE = 20.0


def sun_irradiance_rgb(haze: SetHaze, apparent_elevation_rad: float) -> FloatArray:
    """Irradiance (3,) by the whole disc on a plane that faces it, linear sRGB, W m^-2.

    May lie below 0 outside the gamut. A sun below the horizon counts as on it.
    """
    wavelength, sun = _sun()
    transmittance = np.exp(-slant_depth(haze, apparent_elevation_rad, wavelength))
    return rgb_from_spectrum(sun * transmittance, wavelength, 0.0)


def slant_depth(
    haze: SetHaze, apparent_elevation_rad: float, wavelength_nm: FloatArray
) -> FloatArray:
    """Optical depth (n,) of all the air between the ground and the sun."""
    sine = max(float(np.sin(apparent_elevation_rad)), 0.0)
    molecules = molecules_per_m(wavelength_nm) * SCALE_HEIGHT_M
    ozone = ozone_per_m(wavelength_nm) * OZONE_HALF_WIDTH_M
    optics = haze.optics
    share = haze.optical_depth_550 / optics.optical_depth_550
    # The light's path through ozone is that at the middle of its tent.
    at_ozone = GROUND_RADIUS_M / (GROUND_RADIUS_M + OZONE_MIDDLE_M)
    through_ozone = 1.0 / np.sqrt(1.0 - at_ozone**2 * (1.0 - sine * sine))
    depth = molecules * _air_mass(sine, SCALE_HEIGHT_M) + ozone * through_ozone
    for layer in optics.layers:
        depth += share * layer.depth_at(wavelength_nm) * _air_mass(sine, layer.height_m)
    return np.asarray(depth)


def extinction_per_m(
    haze: SetHaze, altitude_m: FloatArray, wavelength_nm: FloatArray
) -> FloatArray:
    """Extinction (..., n) of the same air at altitudes (...,), 1/m."""
    return np.asarray(extinctions_per_m(haze, altitude_m, wavelength_nm).sum(axis=0))


def extinctions_per_m(
    haze: SetHaze, altitude_m: FloatArray, wavelength_nm: FloatArray
) -> FloatArray:
    """Extinction by ozone, molecules and each layer of aerosol, (2 + layers, ..., n), 1/m."""
    altitude = np.asarray(altitude_m, dtype=float)[..., None]
    optics = haze.optics
    share = haze.optical_depth_550 / optics.optical_depth_550
    molecules = molecules_per_m(wavelength_nm) * np.exp(-altitude / SCALE_HEIGHT_M)
    found = [ozone_per_m(wavelength_nm) * ozone_density(altitude), molecules]
    for layer in optics.layers:
        at_foot = share / layer.height_m * layer.depth_at(wavelength_nm)
        found.append(at_foot * np.exp(-altitude / layer.height_m))
    return np.stack(found)


def _air_mass(sine: float, scale_height_m: float) -> float:
    half = 0.5 * GROUND_RADIUS_M / scale_height_m
    return math.sqrt(math.pi * half) * _erfcx(math.sqrt(half) * sine)


def _erfcx(x: float) -> float:
    """exp(x^2) erfc(x) of x >= 0, to 1e-9: scipy's takes 0.1 s to import at each start."""
    if x < _LARGE:
        return math.exp(x * x) * math.erfc(x)
    # Abramowitz and Stegun 1964, 7.1.23.
    t = 0.5 / (x * x)
    return (1.0 - t * (1.0 - 3.0 * t * (1.0 - 5.0 * t))) / (x * math.sqrt(math.pi))


@lru_cache(maxsize=1)
def _sun() -> tuple[FloatArray, FloatArray]:
    """Wavelengths (95,) in nm and the sun's irradiance above the air."""
    wavelength = colour_table()[:, 0]
    return wavelength, solar_irradiance(wavelength)

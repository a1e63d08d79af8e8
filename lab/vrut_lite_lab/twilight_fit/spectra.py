"""From spectra of the sky to linear sRGB that a display can show."""

import numpy as np

from vrut_lite.geometry.colour import luminance, rgb_from_spectrum, solar_irradiance
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.twilight_fit.air import WAVELENGTH_NM

# A colour outside sRGB is mixed with grey of its luminance until no channel is below this share.
LEAST_CHANNEL = 0.02
FINE_NM = np.arange(360.0, 781.0, 5.0)


def rgb_of(radiance: FloatArray, wavelength_nm: FloatArray = WAVELENGTH_NM) -> FloatArray:
    """Linear sRGB (..., 3) of radiance (..., C) per nm, integrated against the CIE observer.

    Between the wavelengths, and beyond their ends, the sun's spectrum is its own: what the air
    makes of it is linear there in its logarithm, and held beyond.
    """
    position = np.interp(FINE_NM, wavelength_nm, np.arange(wavelength_nm.size))
    low = np.minimum(position.astype(int), wavelength_nm.size - 2)
    part = position - low
    logarithm = np.log(np.maximum(radiance / solar_irradiance(wavelength_nm), 1e-300))
    fine = np.exp(logarithm[..., low] * (1.0 - part) + logarithm[..., low + 1] * part)
    return in_gamut(rgb_from_spectrum(fine * solar_irradiance(FINE_NM), FINE_NM))


def in_gamut(rgb: FloatArray) -> FloatArray:
    """The same luminances (..., 3), each colour as saturated as sRGB allows."""
    grey = luminance(rgb)[..., None]
    lowest = rgb.min(axis=-1, keepdims=True)
    short = np.maximum(LEAST_CHANNEL * grey - lowest, 0.0)
    return rgb + (grey - rgb) * short / np.maximum(grey - lowest, 1e-300)

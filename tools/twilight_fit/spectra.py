"""From radiance at nine wavelengths to linear sRGB."""

import numpy as np
from numpy.typing import NDArray

from tools.twilight_fit.air import WAVELENGTH_NM
from vrut_lite.geometry.colour import luminance, rgb_from_spectrum, solar_irradiance

FloatArray = NDArray[np.float64]
# A colour outside sRGB is mixed with grey of its luminance until no channel is below this share.
LEAST_CHANNEL = 0.02
FINE_NM = np.arange(360.0, 781.0, 5.0)


def rgb_of(transfer: FloatArray, wavelength_nm: FloatArray = WAVELENGTH_NM) -> FloatArray:
    """Linear sRGB (..., 3) of radiance per unit of solar irradiance (..., C), in gamut.

    Between the wavelengths ln of the transfer is linear, and the sun's spectrum is its own.
    """
    position = np.interp(FINE_NM, wavelength_nm, np.arange(wavelength_nm.size))
    low = np.minimum(position.astype(int), wavelength_nm.size - 2)
    part = position - low
    logarithm = np.log(np.maximum(transfer, 1e-300))
    fine = np.exp(logarithm[..., low] * (1.0 - part) + logarithm[..., low + 1] * part)
    rgb = rgb_from_spectrum(fine * solar_irradiance(FINE_NM), FINE_NM)
    grey = luminance(rgb)[..., None]
    lowest = rgb.min(axis=-1, keepdims=True)
    short = np.maximum(LEAST_CHANNEL * grey - lowest, 0.0)
    return rgb + (grey - rgb) * short / np.maximum(grey - lowest, 1e-300)

"""Transmittance of air for red, green and blue from that at some wavelengths.

A channel's transmittance is that of sunlight off a grey surface, seen through the air. With the
four wavelengths of skylight it errs by 0.004 at most, and by 1.5 % where it is 0.1 or more, against
95 wavelengths (molecules and haze in any mixture and depth).
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray

_LEAST_TRANSMITTANCE = 1e-30
# Upper bound of a channel's optical depth over the largest at the wavelengths: blue extends to
# shorter ones.
_MOST_DEPTH = 1.5


def shares_of_white(
    wavelength_nm: ArrayLike, solar_irradiance: ArrayLike, solar_exponent: float = 3.0
) -> FloatArray:
    """Weight (C, 3) of each wavelength in each channel of sunlight; columns sum to 1.

    Weights may be negative, as in the colour matrix that they come from.
    """
    count = np.size(np.asarray(wavelength_nm))
    matrix = rgb_from_spectrum(np.eye(count), wavelength_nm, solar_exponent)
    white = matrix * np.asarray(solar_irradiance, dtype=float)[:, None]
    return np.asarray(white / white.sum(axis=0))


def lost_and_depth(lost: ArrayLike, shares: FloatArray) -> tuple[FloatArray, FloatArray]:
    """1 - T and optical depth (..., 3) of the channels from 1 - T (..., C) of wavelengths."""
    spectral = np.asarray(lost, dtype=float)
    # With negative shares, air that absorbs only one wavelength would brighten another's channel.
    channels = np.maximum(spectral @ shares, 0.0)
    # Light without nearly all its blue lies outside the gamut: keep the channel above 0.
    least = (1.0 - spectral.max(axis=-1, keepdims=True)) ** _MOST_DEPTH
    least = np.maximum(least, _LEAST_TRANSMITTANCE)
    thin = -np.log1p(-np.minimum(channels, 0.5))
    depth = np.where(channels < 0.5, thin, -np.log(np.maximum(1.0 - channels, least)))
    return -np.expm1(-depth), depth

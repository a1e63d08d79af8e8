"""What air takes from red, green and blue, when it is known what it takes from wavelengths.

One transmittance per channel stands for a spectrum's: that of sunlight off a grey thing, seen
through the air. By the four wavelengths of skylight it errs by 0.004 at most, and where it is 0.1
or more by 1.5 % of itself, against 95 wavelengths (molecules and haze of any share and depth).
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray

_LEAST_TRANSMITTANCE = 1e-30
# A channel's optical depth over the largest of the wavelengths', at most: blue has shorter ones.
_MOST_DEPTH = 1.5


def shares_of_white(
    wavelength_nm: ArrayLike, solar_irradiance: ArrayLike, solar_exponent: float = 3.0
) -> FloatArray:
    """Which share (C, 3) of each channel of sunlight stands for each wavelength; they sum to 1.

    Shares may be negative, as in the colour matrix that they come from.
    """
    count = np.size(np.asarray(wavelength_nm))
    matrix = rgb_from_spectrum(np.eye(count), wavelength_nm, solar_exponent)
    white = matrix * np.asarray(solar_irradiance, dtype=float)[:, None]
    return np.asarray(white / white.sum(axis=0))


def lost_and_depth(lost: ArrayLike, shares: FloatArray) -> tuple[FloatArray, FloatArray]:
    """1 - T and optical depth (..., 3) of the channels from 1 - T (..., C) of wavelengths."""
    spectral = np.asarray(lost, dtype=float)
    # Shares may be negative: what takes one wavelength alone would add to another's channel.
    channels = np.maximum(spectral @ shares, 0.0)
    # Light that has lost nearly all its blue lies outside the gamut: its channel is held above 0.
    least = (1.0 - spectral.max(axis=-1, keepdims=True)) ** _MOST_DEPTH
    least = np.maximum(least, _LEAST_TRANSMITTANCE)
    thin = -np.log1p(-np.minimum(channels, 0.5))
    depth = np.where(channels < 0.5, thin, -np.log(np.maximum(1.0 - channels, least)))
    return -np.expm1(-depth), depth

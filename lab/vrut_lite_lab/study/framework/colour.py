"""Luminance and colour of spectra of 40 samples, as the evaluation defines them.

All colours are linear sRGB in cd m^-2 (XYZ times 683 lm/W). They differ from those of
`vrut_lite.geometry.colour` in the integral alone: here it is a sum over 40 bins.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.geometry.colour import LUMENS_PER_WATT, SRGB_FROM_XYZ, colour_table
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.spectra import (
    BIN_NM,
    WAVELENGTHS_NM,
    at_wavelength,
    resampled,
)
from vrut_lite_lab.study.framework.tables import table_spectra

# Where a renderer of three wavelengths samples red, green and blue.
SAMPLES_NM = (680.0, 550.0, 440.0)
# Radiance of 5 W m^-2 sr^-1 of green light reaches 1 - 1/e of white.
WHITE_LUMINANCE = 5.0 * LUMENS_PER_WATT


@lru_cache(maxsize=1)
def colour_matching() -> FloatArray:
    """The CIE 1931 observer (3, 40)."""
    table = colour_table()
    return resampled(table[:, 0], table[:, 1:4].T)


def luminance(radiance: ArrayLike) -> FloatArray:
    """Luminance (...,) in cd m^-2 of spectral radiance (..., 40)."""
    return xyz(radiance)[..., 1]


def xyz(radiance: ArrayLike) -> FloatArray:
    """CIE XYZ (..., 3), Y in cd m^-2, of spectral radiance (..., 40)."""
    scaled = LUMENS_PER_WATT * BIN_NM * np.asarray(radiance, dtype=float)
    return np.asarray(scaled @ colour_matching().T)


def srgb(radiance: ArrayLike) -> FloatArray:
    """Linear sRGB (..., 3) of spectral radiance (..., 40), negative components cut to 0."""
    return np.maximum(xyz(radiance) @ SRGB_FROM_XYZ.T, 0.0)


def three_sample_srgb(radiance: ArrayLike) -> FloatArray:
    """Bruneton's colour (..., 3) from three wavelengths: exact for light as sun/nm^3."""
    typical = STUDY.solar_irradiance * WAVELENGTHS_NM**-3
    at_samples = at_wavelength(STUDY.solar_irradiance, SAMPLES_NM) * np.power(SAMPLES_NM, -3)
    factor = (xyz(typical) @ SRGB_FROM_XYZ.T) / at_samples
    return np.asarray(at_wavelength(radiance, SAMPLES_NM) * factor)


def approximate_spectrum(radiance: ArrayLike) -> FloatArray:
    """The spectrum (..., 40) of daylight that has the 3-sample colour of a spectrum (..., 40)."""
    tristimulus = three_sample_srgb(radiance) @ np.linalg.inv(SRGB_FROM_XYZ).T
    x, y, _ = np.moveaxis(tristimulus / tristimulus.sum(axis=-1, keepdims=True), -1, 0)
    return daylight_spectrum(tristimulus[..., 1], x, y)


def daylight_spectrum(luminance: ArrayLike, x: ArrayLike, y: ArrayLike) -> FloatArray:
    """Spectral radiance (..., 40) of daylight from luminance (cd m^-2) and chromaticity (...,).

    CIE 15:2004, as Preetham et al. 1999, appendix A.5, use it.
    """
    red, green = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    below = 0.0241 + 0.2562 * red - 0.7341 * green
    first = (-1.3515 - 1.7703 * red + 5.9114 * green) / below
    second = (0.0300 - 31.4424 * red + 30.0717 * green) / below
    parts = np.stack([np.ones_like(first), first, second], axis=-1)
    components = table_spectra("daylight_cie")
    of_shape = LUMENS_PER_WATT * BIN_NM * (parts @ (components @ colour_matching()[1]))
    return np.asarray(
        (parts @ components) * (np.asarray(luminance, dtype=float) / of_shape)[..., None]
    )


def tone_mapped(colour: ArrayLike) -> FloatArray:
    """1 - exp(-c / 3415 cd m^-2) of colours (..., 3): what the pictures show, without gamma."""
    return np.asarray(-np.expm1(-np.asarray(colour, dtype=float) / WHITE_LUMINANCE))


def chromaticity(colour: ArrayLike) -> FloatArray:
    """Colours (..., 3) over their largest component; black stays black."""
    values = np.asarray(colour, dtype=float)
    largest = values.max(axis=-1, keepdims=True)
    return np.divide(values, largest, out=np.zeros_like(values), where=largest > 0.0)

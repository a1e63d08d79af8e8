"""Spectra of daylight by CIE's three components, for light of which only a colour is known.

A spectrum of daylight is S0 + M1 S1 + M2 S2 (Judd, MacAdam and Wyszecki 1964; CIE 15:2018). Three
components have one sum for each colour: white light is D65, light on the daylight locus the
illuminant of the D series of its colour temperature.
"""

from functools import lru_cache
from importlib.resources import files

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.geometry.colour import SRGB_FROM_XYZ, colour_table
from vrut_lite.numeric_types import FloatArray

# CIE 15:2018, of D65.
_D65_COMPONENTS = (1.0, -0.295, -0.689)


def d65(wavelength_nm: ArrayLike) -> FloatArray:
    """Relative spectrum (...,) of CIE's illuminant D65, 100 at 560 nm."""
    return components(wavelength_nm) @ np.array(_D65_COMPONENTS)


def components(wavelength_nm: ArrayLike) -> FloatArray:
    """Components S0, S1 and S2 (..., 3) at wavelengths (...,), linear between each 5 nm."""
    table, nm = _table(), np.asarray(wavelength_nm, float)
    return np.stack([np.interp(nm, table[:, 0], part) for part in table[:, 1:].T], axis=-1)


def daylight_of_rgb(rgb: ArrayLike, wavelength_nm: ArrayLike) -> FloatArray:
    """Spectra (..., W) per nm of light with colours (..., 3), linear sRGB, CIE-weighted.

    The colour is exact where no value is below zero; such values are cut off, as those of light
    that is yellower or bluer than daylight can be.
    """
    return np.maximum(np.asarray(rgb, float) @ daylight_of_primaries(wavelength_nm), 0.0)


def daylight_of_primaries(wavelength_nm: ArrayLike) -> FloatArray:
    """Sums of the components (3, W) with the colours red, green and blue of 1; they go below 0."""
    return np.asarray(_of_primaries() @ components(wavelength_nm).T)


@lru_cache(maxsize=1)
def _of_primaries() -> FloatArray:
    """Shares (3, 3) of the components, a row for red, green and blue of 1."""
    table = colour_table()
    step_nm = table[1, 0] - table[0, 0]
    rgb = components(table[:, 0]).T @ table[:, 1:4] @ SRGB_FROM_XYZ.T * step_nm
    return np.asarray(np.linalg.inv(rgb))


@lru_cache(maxsize=1)
def _table() -> FloatArray:
    source = files("daylight_numbers.spectra") / "data" / "daylight_components.csv"
    with source.open(encoding="utf-8") as lines:
        table: FloatArray = np.loadtxt(lines, delimiter=",")
    return table

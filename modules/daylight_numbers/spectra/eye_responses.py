"""Illuminance, alpha-opic irradiances and chromaticity of spectra: sums with CIE's curves.

Alpha-opic quantities are those of CIE S 026:2018; the equivalent daylight illuminance (EDI) is the
illuminance of D65 that has the same alpha-opic irradiance.
"""

from functools import lru_cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from daylight_numbers.spectra.daylight import d65
from vrut_lite.geometry.colour import LUMENS_PER_WATT, colour_table
from vrut_lite.numeric_types import FloatArray

# The photoreceptors in the order of CIE S 026, table 2.
RECEPTORS = ("s_cone", "m_cone", "l_cone", "rhodopic", "melanopic")
MELANOPIC = RECEPTORS.index("melanopic")
LOWEST_NM, HIGHEST_NM = 380.0, 780.0
_COLOUR_NM = np.arange(360.0, 831.0)


class EyeResponses(NamedTuple):
    """Responses (...,) to light by its spectrum.

    `xyz` (..., 3): CIE 1931 tristimulus values in the spectrum's unit times nm (W m^-2 for an
    irradiance per nm); `alpha_opic` (..., 5): irradiances by `RECEPTORS`, W m^-2.
    """

    xyz: FloatArray
    alpha_opic: FloatArray

    @property
    def illuminance_lx(self) -> FloatArray:
        """Illuminance (...,) in lux."""
        return np.asarray(LUMENS_PER_WATT * self.xyz[..., 1])

    @property
    def edi_lx(self) -> FloatArray:
        """Equivalent daylight (D65) illuminances (..., 5) in lux, by `RECEPTORS`."""
        return np.asarray(self.alpha_opic / alpha_opic_efficacy_of_d65())


def eye_responses(spectral: ArrayLike, wavelength_nm: ArrayLike) -> EyeResponses:
    """Responses to spectra (..., W) in W m^-2 nm^-1, sampled at wavelengths (W,) in nm.

    Spectra are linear between samples, and zero outside them. Colour is summed from 360 to 830 nm,
    alpha-opic irradiance from 380 to 780 nm. Of daylight each 10 nm from 380 to 780 nm the error is
    below 0.1 %, and 5 K in its colour temperature.
    """
    nm = np.asarray(wavelength_nm, float)
    found = np.asarray(spectral, float) @ response_matrix(tuple(nm.tolist()))
    return EyeResponses(found[..., :3], found[..., 3:])


@lru_cache(maxsize=16)
def response_matrix(wavelength_nm: tuple[float, ...]) -> FloatArray:
    """Matrix (W, 8) in nm that turns spectra into X, Y, Z and alpha-opic irradiances."""
    nodes = np.asarray(wavelength_nm, float)
    inside = nodes[(nodes >= _COLOUR_NM[0]) & (nodes <= _COLOUR_NM[-1])]
    nm = np.unique(np.concatenate([_COLOUR_NM, inside]))
    # Trapezoids, each half of the gaps on both sides.
    step_nm = np.zeros_like(nm)
    step_nm[:-1] += 0.5 * np.diff(nm)
    step_nm[1:] += 0.5 * np.diff(nm)
    rising = np.argsort(nodes)
    hats = np.stack(
        [
            np.interp(nm, nodes[rising], unit[rising], left=0.0, right=0.0)
            for unit in np.eye(nodes.size)
        ]
    )
    return np.asarray((hats * step_nm) @ _curves(nm))


@lru_cache(maxsize=1)
def action_spectra() -> FloatArray:
    """Columns wavelength (nm) and the action spectra of `RECEPTORS`, each 1 nm (CIE S 026)."""
    source = files("daylight_numbers.spectra") / "data" / "alpha_opic.csv"
    with source.open(encoding="utf-8") as lines:
        table: FloatArray = np.loadtxt(lines, delimiter=",")
    table.flags.writeable = False
    return table


@lru_cache(maxsize=1)
def alpha_opic_efficacy_of_d65() -> FloatArray:
    """Alpha-opic irradiance (5,) of a lux of D65, W m^-2 lx^-1; melanopic 1.3262e-3 (CIE S 026)."""
    nm = action_spectra()[:, 0]
    found = d65(nm) @ response_matrix(tuple(nm.tolist()))
    return np.asarray(found[3:] / (LUMENS_PER_WATT * found[1]))


def _curves(nm: FloatArray) -> FloatArray:
    """x_bar, y_bar, z_bar and the action spectra (n, 8) at wavelengths (n,)."""
    table, action = colour_table(), action_spectra()
    colour = np.maximum(CubicSpline(table[:, 0], table[:, 1:4])(nm), 0.0)
    receptors = [
        np.interp(nm, action[:, 0], curve, left=0.0, right=0.0) for curve in action[:, 1:].T
    ]
    return np.column_stack([colour, *receptors])

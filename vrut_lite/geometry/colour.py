"""Spectra to linear sRGB, in one place for every sky.

All RGB is linear sRGB from CIE-weighted radiance, W m^-2 sr^-1: XYZ = integral of cmf * L,
not multiplied by 683 lm/W. Times `LUMENS_PER_WATT`, Y is a luminance in cd m^-2.
"""

from functools import lru_cache
from importlib.resources import files

import numpy as np
from numpy.typing import ArrayLike, NDArray

LUMENS_PER_WATT = 683.0
# IEC 61966-2-1, inverted; the rows are the red, green and blue of an XYZ.
SRGB_FROM_XYZ = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)
# Red, green, blue, white, each x and y: ITU-R BT.709 and D65, sRGB's own.
SRGB_CHROMATICITIES = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
LUMINANCE_WEIGHTS = np.linalg.inv(SRGB_FROM_XYZ)[1]
# Four wavelengths whose radiance determines the colour of clear skylight by day and twilight, and
# the linear sRGB of radiance over solar irradiance at each of them, by vrut_lite_lab.colour_fit.
SKYLIGHT_NM = (635.0, 570.0, 520.0, 445.0)
RGB_OF_TRANSFER = np.array(
    [
        [155.46, -8.54, -1.98],
        [161.50, 88.32, -22.71],
        [-113.79, 124.42, 28.12],
        [11.47, -13.95, 180.23],
    ]
)
_FEWEST_FOR_INTEGRATION = 8


@lru_cache(maxsize=1)
def colour_table() -> NDArray[np.float64]:
    """Columns wavelength (nm), x_bar, y_bar, z_bar, solar irradiance (W m^-2 nm^-1), each 5 nm."""
    source = files("vrut_lite.geometry") / "data" / "cie1931_astm_g173.csv"
    with source.open(encoding="utf-8") as lines:
        table = np.loadtxt(lines, delimiter=",")
    table.flags.writeable = False
    return table


def solar_irradiance(wavelength_nm: ArrayLike) -> NDArray[np.float64]:
    """Extraterrestrial irradiance (...,) in W m^-2 nm^-1, ASTM G-173-03 in 5 nm means."""
    table = colour_table()
    return np.interp(np.asarray(wavelength_nm, dtype=float), table[:, 0], table[:, 4])


def luminance(rgb: ArrayLike) -> NDArray[np.float64]:
    """CIE Y (...,) of linear sRGB (..., 3), in the unit of the input; times 683 for cd m^-2."""
    return np.asarray(rgb, dtype=float) @ LUMINANCE_WEIGHTS


def rgb_from_spectrum(
    spectral: ArrayLike, wavelength_nm: ArrayLike, solar_exponent: float = 3.0
) -> NDArray[np.float64]:
    """Linear sRGB (..., 3) of spectra (..., C) per nm, sampled at wavelengths (C,) in nm.

    Eight wavelengths or more are integrated against the CIE observer, linear between
    samples and zero outside them. The four of SKYLIGHT_NM, in their order, are turned into the
    colour of a clear sky by a fitted matrix, within 0.1 % of its luminance in the mean. Three
    are taken as the 3-sample colour of Bruneton 2016 ("A Qualitative and Quantitative
    Evaluation of 8 Clear Sky Models", section 4), red first, with the spectrum between them
    falling as the sun's times wavelength^-`solar_exponent`: 3 for skylight, 0 for sunlight.
    Components may be negative: colours outside the gamut.

    Raises:
        ValueError: for another number of wavelengths, or four others.
    """
    wavelength = np.asarray(wavelength_nm, dtype=float)
    values = np.asarray(spectral, dtype=float)
    if wavelength.size >= _FEWEST_FOR_INTEGRATION:
        return values @ integration_matrix(tuple(wavelength))
    if tuple(wavelength) == SKYLIGHT_NM:
        return values @ skylight_matrix()
    if wavelength.size == 3:
        return values * three_sample_scale(tuple(wavelength), solar_exponent)
    raise ValueError(
        f"colour needs 3 wavelengths, or 8 and more, not {wavelength.size}, "
        f"unless they are {', '.join(f'{nm:g}' for nm in SKYLIGHT_NM)} nm"
    )


@lru_cache(maxsize=1)
def skylight_matrix() -> NDArray[np.float64]:
    """Matrix (4, 3) in nm that turns radiance at SKYLIGHT_NM into linear sRGB.

    It is fitted to radiance over solar irradiance, so it is independent of the sun's spectrum:
    a dimmer or redder sun dims or reddens the colour.
    """
    return RGB_OF_TRANSFER / solar_irradiance(SKYLIGHT_NM)[:, None]


@lru_cache(maxsize=16)
def integration_matrix(wavelength_nm: tuple[float, ...]) -> NDArray[np.float64]:
    """Matrix (C, 3) that turns spectra on the given wavelengths, in any order, into linear sRGB."""
    table = colour_table()
    nodes = np.asarray(wavelength_nm, dtype=float)
    rising = np.argsort(nodes)
    hats = np.stack(
        [
            np.interp(table[:, 0], nodes[rising], unit[rising], left=0.0, right=0.0)
            for unit in np.eye(nodes.size)
        ]
    )
    step_nm = table[1, 0] - table[0, 0]
    return (hats * step_nm) @ table[:, 1:4] @ SRGB_FROM_XYZ.T


@lru_cache(maxsize=16)
def three_sample_scale(
    wavelength_nm: tuple[float, ...], solar_exponent: float
) -> NDArray[np.float64]:
    """Factors (3,) in nm that turn radiance at three wavelengths into linear sRGB."""
    table = colour_table()
    fine_nm, step_nm = table[:, 0], table[1, 0] - table[0, 0]
    shape = table[:, 4] * fine_nm**-solar_exponent
    rgb = SRGB_FROM_XYZ @ (table[:, 1:4].T @ shape) * step_nm
    at = np.asarray(wavelength_nm, dtype=float)
    return rgb / (solar_irradiance(at) * at**-solar_exponent)


def srgb_encode(linear: ArrayLike) -> NDArray[np.float64]:
    """The sRGB transfer function (IEC 61966-2-1) of linear values, clamped to [0, 1]."""
    c = np.clip(np.asarray(linear, dtype=float), 0.0, 1.0)
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


def srgb_decode(encoded: ArrayLike) -> NDArray[np.float64]:
    """Linear values (...,) of sRGB-encoded ones (IEC 61966-2-1), clamped to [0, 1]."""
    c = np.clip(np.asarray(encoded, dtype=float), 0.0, 1.0)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)

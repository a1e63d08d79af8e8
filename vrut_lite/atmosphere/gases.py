"""Scattering and absorption by the gases of air: cross sections and vertical optical depths.

Molecules as in Bodhaine, Wood, Dutton and Slusser 1999 ("On Rayleigh Optical Depth Calculations",
J. Atmos. Oceanic Technol. 16, 1854): refractive index of Peck and Reeder 1972, King's factor of
each gas, the column from pressure and gravity. Ozone, nitrogen dioxide and pairs of oxygen
molecules absorb by measured cross sections, water vapour by its lines in bands of 5 nm.
"""

from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.numeric_types import FloatArray

_FILE = Path(__file__).parent / "data" / "water_vapour.csv"
DOBSON_UNIT_PER_M2 = 2.687e20
STANDARD_PRESSURE_PA = 101_325.0
# Molecules per m^3 at 288.15 K and 1013.25 hPa, of which the refractive index is.
_STANDARD_PER_M3 = 2.546899e25
_AVOGADRO_PER_KMOL = 6.0221367e26
# Share of carbon dioxide in the air, as Bodhaine et al. tabulate it.
_CARBON_DIOXIDE = 360e-6
OXYGEN_SHARE = 0.20946
# Gravity in m s^-2 at latitude 45 degrees and the mean height of the air's mass over sea level.
_GRAVITY = 9.789_16
# The middles of 10 nm means.
_OZONE_FIRST_NM, _OZONE_STEP_NM = 365.0, 10.0
# Absorption cross sections in m^2, means of 10 nm each from 360 to 840 nm, University of Bremen
# (Serdyuchenko et al. 2011, at 233 K), in the selection of Bruneton's 2017 demonstration.
_OZONE_M2 = np.array(
    [
        1.18e-27, 2.182e-28, 2.818e-28, 6.636e-28, 1.527e-27, 2.763e-27, 5.52e-27, 8.451e-27,
        1.582e-26, 2.316e-26, 3.669e-26, 4.924e-26, 7.752e-26, 9.016e-26, 1.48e-25, 1.602e-25,
        2.139e-25, 2.755e-25, 3.091e-25, 3.5e-25, 4.266e-25, 4.672e-25, 4.398e-25, 4.701e-25,
        5.019e-25, 4.305e-25, 3.74e-25, 3.215e-25, 2.662e-25, 2.238e-25, 1.852e-25, 1.473e-25,
        1.209e-25, 9.423e-26, 7.455e-26, 6.566e-26, 5.105e-26, 4.15e-26, 4.228e-26, 3.237e-26,
        2.451e-26, 2.801e-26, 2.534e-26, 1.624e-26, 1.465e-26, 2.078e-26, 1.383e-26, 7.105e-27,
    ]
)  # fmt: skip
# The same of nitrogen dioxide about 360 to 700 nm at 250 K: Bogumil et al. 2003, "Measurements of
# Molecular Absorption Spectra with the SCIAMACHY Pre-Flight Model", J. Photochem. Photobiol. A 157.
_NITROGEN_DIOXIDE_FIRST_NM = 360.0
_NITROGEN_DIOXIDE_M2 = np.array(
    [
        5.146e-23, 5.694e-23, 6.066e-23, 6.202e-23, 6.318e-23, 6.234e-23, 5.938e-23, 5.429e-23,
        5.114e-23, 4.851e-23, 4.458e-23, 3.681e-23, 3.247e-23, 2.964e-23, 2.316e-23, 2.215e-23,
        1.528e-23, 1.608e-23, 1.069e-23, 1.099e-23, 7.053e-24, 7.567e-24, 4.001e-24, 5.394e-24,
        3.131e-24, 2.574e-24, 2.693e-24, 1.311e-24, 1.545e-24, 1.412e-24, 5.434e-25, 8.944e-25,
        6.525e-25, 3.062e-25, 2.51e-25,
    ]
)  # fmt: skip
# Bands of pairs of oxygen molecules: centre (nm), peak (m^5 per pair) and full width at half
# maximum (nm) of a Gaussian: Greenblatt, Orlando, Burkholder and Ravishankara 1990, "Absorption
# Measurements of Oxygen between 330 and 1140 nm", J. Geophys. Res. 95, 18577.
_OXYGEN_PAIRS = (
    (360.5, 4.1e-56, 4.8),
    (380.2, 2.4e-56, 4.4),
    (446.7, 0.57e-56, 5.6),
    (477.3, 6.3e-56, 6.2),
    (532.2, 1.0e-56, 10.2),
    (577.2, 11.0e-56, 11.6),
    (630.0, 7.2e-56, 13.8),
)
_WIDTHS_PER_SIGMA = 2.0 * np.sqrt(2.0 * np.log(2.0))


def king_factor(wavelength_nm: ArrayLike) -> FloatArray:
    """King's factor (...,) of air: what the molecules' anisotropy adds to their scattering.

    Bates 1984, as in Bodhaine et al. 1999, equations 5, 6 and 23.
    """
    square = (np.asarray(wavelength_nm, dtype=float) / 1000.0) ** -2
    nitrogen = 1.034 + 3.17e-4 * square
    oxygen = 1.096 + 1.385e-3 * square + 1.448e-4 * square**2
    carbon_dioxide = 100.0 * _CARBON_DIOXIDE
    parts = 78.084 * nitrogen + 20.946 * oxygen + 0.934 + carbon_dioxide * 1.15
    return np.asarray(parts / (78.084 + 20.946 + 0.934 + carbon_dioxide))


def depolarisation(wavelength_nm: ArrayLike) -> FloatArray:
    """Depolarisation (...,) of air's molecules for natural light, from King's factor."""
    king = king_factor(wavelength_nm)
    return np.asarray(6.0 * (king - 1.0) / (3.0 + 7.0 * king))


def rayleigh_optical_depth(
    wavelength_nm: ArrayLike, pressure_pa: float = STANDARD_PRESSURE_PA
) -> FloatArray:
    """Vertical optical depth (...,) of all the molecules above a pressure.

    Bodhaine et al. 1999, equations 4 and 15 to 25, within 0.1 % of their table 3 from 300 to
    800 nm.
    """
    nm = np.asarray(wavelength_nm, dtype=float)
    square = (nm / 1000.0) ** -2
    refractivity = (
        8060.51 + 2_480_990.0 / (132.274 - square) + 17_455.7 / (39.32957 - square)
    ) * 1e-8
    refractivity *= 1.0 + 0.54 * (_CARBON_DIOXIDE - 300e-6)
    section_m2 = king_factor(nm) * rayleigh_scattering(nm, 1.0 + refractivity, _STANDARD_PER_M3)
    # Lorentz and Lorenz's local field, 3 / (n^2 + 2) squared, which a thin gas may leave out.
    section_m2 *= (3.0 / ((1.0 + refractivity) ** 2 + 2.0)) ** 2 / _STANDARD_PER_M3
    return np.asarray(section_m2 * molecules_per_m2(pressure_pa))


def molecules_per_m2(pressure_pa: float = STANDARD_PRESSURE_PA) -> float:
    """Molecules above a square metre."""
    kilograms_per_kmol = 28.9595 + 15.0556 * _CARBON_DIOXIDE
    return pressure_pa * _AVOGADRO_PER_KMOL / (kilograms_per_kmol * _GRAVITY)


def ozone_absorption(
    wavelength_nm: ArrayLike, dobson_units: float, layer_m: float
) -> NDArray[np.float64]:
    """Absorption coefficient (...,) in 1/m where ozone is densest.

    Args:
        wavelength_nm: in nm; outside 365 to 835 nm the nearest value serves.
        dobson_units: ozone of the whole column.
        layer_m: integral over altitude of the layer's relative density.
    """
    nodes_nm = _OZONE_FIRST_NM + _OZONE_STEP_NM * np.arange(_OZONE_M2.size)
    section_m2 = np.interp(np.asarray(wavelength_nm, dtype=float), nodes_nm, _OZONE_M2)
    return np.asarray(section_m2 * dobson_units * DOBSON_UNIT_PER_M2 / layer_m)


def oxygen_pair_section_m5(wavelength_nm: ArrayLike, band_nm: float = 0.0) -> FloatArray:
    """Absorption (...,) by pairs of oxygen molecules per squared number density of oxygen, m^5.

    `band_nm` is the full width of the Gaussian band that a wavelength stands for.
    """
    nm = np.asarray(wavelength_nm, dtype=float)[..., None]
    centre, peak, width = np.transpose(_OXYGEN_PAIRS)
    wide = np.hypot(width, band_nm)
    sigma = wide / _WIDTHS_PER_SIGMA
    return np.asarray((peak * width / wide * np.exp(-0.5 * ((nm - centre) / sigma) ** 2)).sum(-1))


def nitrogen_dioxide_optical_depth(wavelength_nm: ArrayLike, dobson_units: float) -> FloatArray:
    """Vertical optical depth (...,) of nitrogen dioxide; outside 360 to 700 nm the nearest value
    serves."""
    nodes_nm = _NITROGEN_DIOXIDE_FIRST_NM + 10.0 * np.arange(_NITROGEN_DIOXIDE_M2.size)
    section_m2 = np.interp(np.asarray(wavelength_nm, dtype=float), nodes_nm, _NITROGEN_DIOXIDE_M2)
    return np.asarray(section_m2 * dobson_units * DOBSON_UNIT_PER_M2)


def water_optical_depth(wavelength_nm: ArrayLike, path_cm: ArrayLike) -> FloatArray:
    """Optical depth (..., n) of water vapour, in bands of 5 nm.

    Its lines saturate: the depth grows by a power of the water on the path, below 1. Oxygen's own
    lines, left out, take 0.03 % of the sun's luminance.

    Args:
        wavelength_nm: (n,); linear between the bands' middles, none below 440 nm.
        path_cm: precipitable water (...,) along the path.
    """
    nodes_nm, amount, power = _water()
    nm = np.asarray(wavelength_nm, dtype=float)
    place = np.interp(nm, nodes_nm, np.arange(float(nodes_nm.size)))
    band = np.minimum(place.astype(int), nodes_nm.size - 2)
    at_nodes = amount * np.asarray(path_cm, dtype=float)[..., None] ** power
    further = place - band
    depth = (1.0 - further) * at_nodes[..., band] + further * at_nodes[..., band + 1]
    return np.where(nm < nodes_nm[0], 0.0, depth)


@lru_cache(maxsize=1)
def _water() -> FloatArray:
    """Wavelength (nm), depth at 1 cm and its power."""
    return np.loadtxt(_FILE, delimiter=",", unpack=True)


def rayleigh_scattering(
    wavelength_nm: ArrayLike,
    refractive_index: ArrayLike,
    molecules_per_m3: float,
    depolarisation: float = 0.0,
) -> NDArray[np.float64]:
    """Scattering coefficient (...,) in 1/m: 8 pi^3 (n^2 - 1)^2 / (3 N lambda^4), by King's factor.

    Equation 2.2 of Hvezda 2020 at altitude zero, and equation 4 of Galaj and Wojciechowski
    2019. Index and density must belong to one pressure and temperature. King's factor
    (6 + 3 d) / (6 - 7 d), which both papers leave out, is 1 for isotropic molecules and 1.06
    for Penndorf's air with d = 0.035.

    Args:
        wavelength_nm: in nm; broadcasts with the index.
        refractive_index: n of the gas, at least 1.
        molecules_per_m3: N, number density of the gas.
        depolarisation: d of the molecules, at least 0 and below 6 / 7.

    Raises:
        ValueError: an argument is outside its range.
    """
    metres = np.asarray(wavelength_nm, dtype=float) * 1e-9
    index = np.asarray(refractive_index, dtype=float)
    if not np.all(metres > 0):
        raise ValueError("wavelength_nm must be positive everywhere")
    if not np.all(index >= 1):
        raise ValueError("refractive_index of a gas must be 1 or more everywhere")
    if not molecules_per_m3 > 0:
        raise ValueError(f"molecules_per_m3 must be positive, not {molecules_per_m3}")
    if not 0 <= depolarisation < 6 / 7:
        raise ValueError(f"depolarisation must be at least 0 and below 6/7, not {depolarisation}")
    king = (6.0 + 3.0 * depolarisation) / (6.0 - 7.0 * depolarisation)
    # n^2 - 1 as a product: of n - 1 = 3e-6 in the air of Mars no digit is lost twice.
    contrast = (index - 1.0) * (index + 1.0)
    return np.asarray(king * 8.0 * np.pi**3 * contrast**2 / (3.0 * molecules_per_m3 * metres**4))

"""Molecules and ozone of real air from publications, independent of the product's optics.

Molecules: B. Bodhaine, N. Wood, E. Dutton and J. Slusser 1999, "On Rayleigh Optical Depth
Calculations", J. Atmos. Oceanic Technol. 16, 1854: equations 22 to 30. Profile: U.S. Standard
Atmosphere 1976. Ozone: S. Anderson, J. Burkholder and R. Talukdar 1990 to 1994.
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray

_CO2_PER_MILLION = 360.0
_AVOGADRO = 6.0221367e23
# Molecules per cm^3 at 288.15 K and 1013.25 hPa, of the refractive index.
_MOLECULES_PER_CM3 = 2.546899e19
# Absorption of ozone (1/cm at standard temperature and pressure) each 5 nm, at 229 K, and
# centimetres of ozone in a Dobson unit.
_OZONE_NM = np.arange(400.0, 721.0, 5.0)
_OZONE_PER_CM = 1e-3 * np.array(
    [
        0, 0, 0.2303, 0.2706, 0.436, 1.058, 1.025, 1.507, 2.619, 3.391, 3.807, 4.301, 8.145,
        7.993, 9.468, 10.86, 18.77, 19.65, 20.57, 22.72, 31.62, 42.17, 40.01, 43.09, 47.56,
        57.68, 70.41, 75.15, 77.17, 84.56, 88.93, 94.52, 105.4, 117.1, 124.9, 128.4, 123.4,
        118.7, 119, 127.9, 138.6, 138, 127.6, 116.6, 108.2, 101.8, 94.66, 87.14, 78.95, 71.83,
        65.96, 60.52, 55.24, 50.16, 44.63, 39.72, 35.71, 32.9, 28.96, 25.15, 21.91, 19.82,
        18.46, 17.76, 15.62,
    ]
)  # fmt: skip
_CM_PER_DU = 1e-3
# Geopotential altitudes (km) from which the temperature gradients (K/km) of 1976 hold.
_BASE_KM = np.array([0.0, 11.0, 20.0, 32.0, 47.0, 51.0, 71.0, 84.852])
_GRADIENT = np.array([-6.5, 0.0, 1.0, 2.8, 0.0, -2.8, -2.0])
_GROUND_K, _KELVIN_PER_KM, _PLANET_KM = 288.15, 34.1632, 6356.766


def king_factor(wavelength_nm: ArrayLike) -> FloatArray:
    """(6 + 3 rho) / (6 - 7 rho) of air, equation 23 with Bates's 1984 N2, O2, Ar and CO2."""
    per_um2 = _per_um2(wavelength_nm)
    nitrogen = 1.034 + 3.17e-4 * per_um2
    oxygen = 1.096 + 1.385e-3 * per_um2 + 1.448e-4 * per_um2**2
    carbon_dioxide = _CO2_PER_MILLION * 1e-4
    whole = 78.084 + 20.946 + 0.934 + carbon_dioxide
    parts = 78.084 * nitrogen + 20.946 * oxygen + 0.934 + 1.15 * carbon_dioxide
    return np.asarray(parts / whole)


def depolarisation(wavelength_nm: ArrayLike) -> FloatArray:
    """rho (...,) of air for light that is not polarised."""
    factor = king_factor(wavelength_nm)
    return np.asarray(6.0 * (factor - 1.0) / (3.0 + 7.0 * factor))


def rayleigh_depth(
    wavelength_nm: ArrayLike, pressure_hpa: float = 1013.25, latitude_deg: float = 45.0,
    altitude_m: float = 0.0,
) -> FloatArray:  # fmt: skip
    """Vertical optical depth (...,) of molecules above a place of that pressure."""
    per_um2 = _per_um2(wavelength_nm)
    # Peck and Reeder 1972, at 300 ppm of CO2; equations 18 and 19.
    at_300 = 1e-8 * (8060.51 + 2480990.0 / (132.274 - per_um2) + 17455.7 / (39.32957 - per_um2))
    index = 1.0 + at_300 * (1.0 + 0.54e-6 * (_CO2_PER_MILLION - 300.0))
    squared, per_cm = index * index, 1e7 / np.asarray(wavelength_nm, dtype=float)
    section_cm2 = 24.0 * np.pi**3 * per_cm**4 * king_factor(wavelength_nm)
    section_cm2 *= ((squared - 1.0) / (squared + 2.0) / _MOLECULES_PER_CM3) ** 2
    gram_per_mole = 28.9595 + 15.0556e-6 * _CO2_PER_MILLION
    column_per_cm2 = 1e3 * pressure_hpa * _AVOGADRO / gram_per_mole
    return np.asarray(section_cm2 * column_per_cm2 / _gravity_cm_s2(latitude_deg, altitude_m))


def ozone_depth(wavelength_nm: ArrayLike, dobson_units: float) -> FloatArray:
    """Vertical optical depth (...,) of ozone, from 400 to 720 nm."""
    per_cm = np.interp(np.asarray(wavelength_nm, dtype=float), _OZONE_NM, _OZONE_PER_CM)
    return np.asarray(per_cm * dobson_units * _CM_PER_DU)


def standard_density(altitude_m: ArrayLike) -> FloatArray:
    """Density (...,) of the standard atmosphere over that on the ground, to 85 km."""
    km = np.asarray(altitude_m, dtype=float) / 1000.0
    geopotential = np.clip(_PLANET_KM * km / (_PLANET_KM + km), 0.0, _BASE_KM[-1])
    at_base = _GROUND_K + np.cumsum([0.0, *(_GRADIENT * np.diff(_BASE_KM))])
    # d ln p = -34.16 dh / T, by the midpoint rule in steps of 5 m.
    steps = np.linspace(0.0, _BASE_KM[-1], 16971)
    warm = np.interp(0.5 * (steps[1:] + steps[:-1]), _BASE_KM, at_base)
    log_pressure = np.cumsum([0.0, *(-_KELVIN_PER_KM * np.diff(steps) / warm)])
    kelvin = np.interp(geopotential, _BASE_KM, at_base)
    return np.asarray(np.exp(np.interp(geopotential, steps, log_pressure)) * _GROUND_K / kelvin)


def _per_um2(wavelength_nm: ArrayLike) -> FloatArray:
    return np.asarray((1000.0 / np.asarray(wavelength_nm, dtype=float)) ** 2)


def _gravity_cm_s2(latitude_deg: float, altitude_m: float) -> float:
    """Gravity at the mean height of the air above a place, equations 26 and 28."""
    cosine = np.cos(2.0 * np.radians(latitude_deg))
    height_m = 0.73737 * altitude_m + 5517.56
    ground = 980.6160 * (1.0 - 0.0026373 * cosine + 0.0000059 * cosine**2)
    first = 3.085462e-4 + 2.27e-7 * cosine
    second = 7.254e-11 + 1e-13 * cosine
    third = 1.517e-17 + 6e-20 * cosine
    return float(ground - first * height_m + second * height_m**2 - third * height_m**3)

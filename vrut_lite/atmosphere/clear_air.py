"""The standard air of the real Earth: densities of its gases by altitude, and their coefficients.

The molecules' density is three exponentials on the U.S. Standard Atmosphere 1976: within 3 % to
8 km, 7.5 % to 50 and 13 % to 60, with its column to 1e-5 (8434.6 m of the density on the ground),
so that the air mass at the horizon is Kasten and Young's. Ozone lies in a tent from 10 to 40 km.
Pairs of oxygen molecules follow the square of the density, nitrogen dioxide the molecules.
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.atmosphere.gases import (
    OXYGEN_SHARE,
    depolarisation,
    molecules_per_m2,
    nitrogen_dioxide_optical_depth,
    oxygen_pair_section_m5,
    ozone_absorption,
    rayleigh_optical_depth,
)
from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.atmosphere.slant_path import BentAir, tent
from vrut_lite.numeric_types import FloatArray

# Exponentials of the density over its value on the ground: shares and scale heights in m.
STANDARD_DENSITY = ((0.1682, 8719.0), (4.8318, 5290.0), (-4.0, 4648.0))
COLUMN_M = sum(share * height_m for share, height_m in STANDARD_DENSITY)
# The same integral of the density's square.
PAIR_COLUMN_M = sum(
    one * two / (1.0 / high + 1.0 / low)
    for one, high in STANDARD_DENSITY
    for two, low in STANDARD_DENSITY
)
TOP_ALTITUDE_M = 120_000.0
# Middle of the tent, and from there to its ends.
OZONE_MIDDLE_M, OZONE_HALF_WIDTH_M = 25_000.0, 15_000.0
OZONE_DU = 300.0
# Background air, and above a city.
NITROGEN_DIOXIDE_DU, CITY_NITROGEN_DIOXIDE_DU = 0.2, 1.0
# Precipitable water of the U.S. Standard Atmosphere and its scale height.
WATER_CM, WATER_HEIGHT_M = 1.416, 2000.0
# n - 1 on the ground at 288 K and 570 nm (Peck and Reeder 1972).
REFRACTIVITY = 2.777e-4
# Depolarisation at 550 nm; 0.031 at 360 and 0.027 at 800, whose phase functions differ by 2e-3.
DEPOLARISATION = float(depolarisation(550.0))
# The tent's kinks.
_KINKS_M = tuple(OZONE_MIDDLE_M + side * OZONE_HALF_WIDTH_M for side in (-1.0, 0.0, 1.0))


def molecule_density(altitude_m: ArrayLike) -> FloatArray:
    """Relative density (...,) of the molecules at altitudes (...,)."""
    height = np.asarray(altitude_m, dtype=float)
    return np.asarray(sum(share * np.exp(-height / scale) for share, scale in STANDARD_DENSITY))


def pair_density(altitude_m: ArrayLike) -> FloatArray:
    """Relative density (...,) of pairs of molecules."""
    return molecule_density(altitude_m) ** 2


def ozone_density(altitude_m: ArrayLike) -> FloatArray:
    """Density (...,) of ozone at altitudes (...,), 1 in the middle of its tent."""
    return tent(OZONE_HALF_WIDTH_M, OZONE_MIDDLE_M, np.asarray(altitude_m, dtype=float))


def molecules_per_m(wavelength_nm: ArrayLike) -> FloatArray:
    """Rayleigh scattering (...,) at sea level, 1/m."""
    return rayleigh_optical_depth(wavelength_nm) / COLUMN_M


def nitrogen_dioxide_per_m(
    wavelength_nm: ArrayLike, dobson_units: float = NITROGEN_DIOXIDE_DU
) -> FloatArray:
    """Absorption (...,) by nitrogen dioxide at sea level, 1/m."""
    return nitrogen_dioxide_optical_depth(wavelength_nm, dobson_units) / COLUMN_M


def oxygen_pairs_per_m(wavelength_nm: ArrayLike, band_nm: float = 0.0) -> FloatArray:
    """Absorption (...,) by pairs of oxygen molecules at sea level, 1/m; see
    `oxygen_pair_section_m5`."""
    oxygen_per_m3 = OXYGEN_SHARE * molecules_per_m2() / COLUMN_M
    return oxygen_pair_section_m5(wavelength_nm, band_nm) * oxygen_per_m3**2


def ozone_per_m(wavelength_nm: ArrayLike, dobson_units: float = OZONE_DU) -> FloatArray:
    """Absorption (...,) by ozone in the middle of its tent, 1/m."""
    return ozone_absorption(wavelength_nm, dobson_units, OZONE_HALF_WIDTH_M)


STANDARD_AIR = BentAir(GROUND_RADIUS_M, TOP_ALTITUDE_M, REFRACTIVITY, molecule_density, _KINKS_M)

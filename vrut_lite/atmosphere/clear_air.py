"""The standard air of the real Earth: densities of its gases by altitude, and their coefficients.

The molecules' scale height changes from layer to layer, as the temperature of the U.S. Standard
Atmosphere 1976 does; their density is within 0.25 % of it to 12 km, 0.6 % to 50 and 2 % to 86.
Ozone lies in a tent from 10 to 40 km.
Pairs of oxygen molecules follow the square of the density, nitrogen dioxide the molecules.
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.atmosphere.exponential_layers import ExponentialLayers
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

# Scale height (m) of the molecules on the ground; altitudes above which it is another, and those.
# Least worst error over 0.2 % of the standard density to 5 km, 0.3 to 12, 0.8 to 50, 2.5 to 86; the
# column is the standard's.
SCALE_HEIGHT_M = 10_318.0
SCALE_HEIGHTS_ABOVE = (
    (1676.0, 9700.0),
    (4478.0, 9015.0),
    (7720.0, 8242.0),
    (10_920.0, 6447.0),
    (14_125.0, 6307.0),
    (27_425.0, 6506.0),
    (39_126.0, 7092.0),
    (46_985.0, 8223.0),
    (62_800.0, 7367.0),
    (73_424.0, 6299.0),
)
STANDARD_DENSITY = ExponentialLayers.of(SCALE_HEIGHT_M, SCALE_HEIGHTS_ABOVE)
COLUMN_M = STANDARD_DENSITY.column_m()
TOP_ALTITUDE_M = 120_000.0
# Middle of the tent, and from there to its ends.
OZONE_MIDDLE_M, OZONE_HALF_WIDTH_M = 25_000.0, 15_000.0
OZONE_DU = 300.0
# Background air, and above a city.
NITROGEN_DIOXIDE_DU, CITY_NITROGEN_DIOXIDE_DU = 0.2, 1.0
# Precipitable water of the U.S. Standard Atmosphere and its scale height.
WATER_CM, WATER_HEIGHT_M = 1.416, 2000.0
# n - 1 on the ground at 288 K and 700 nm (Peck and Reeder 1972), as in Kasten and Young's tables: a
# sun at the horizon is red.
REFRACTIVITY = 2.76e-4
# Depolarisation at 550 nm; 0.031 at 360 and 0.027 at 800, whose phase functions differ by 2e-3.
DEPOLARISATION = float(depolarisation(550.0))
# The tent's kinks.
_KINKS_M = tuple(OZONE_MIDDLE_M + side * OZONE_HALF_WIDTH_M for side in (-1.0, 0.0, 1.0))


def molecule_density(altitude_m: ArrayLike) -> FloatArray:
    """Relative density (...,) of the molecules at altitudes (...,)."""
    return STANDARD_DENSITY.density(altitude_m)


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

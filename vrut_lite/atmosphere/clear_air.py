"""The gases of a clear atmosphere, as Bruneton's demonstration of 2017 has them.

Molecules thin exponentially with height; ozone lies in a tent from 10 to 40 km.
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.atmosphere.gases import ozone_absorption
from vrut_lite.numeric_types import FloatArray

SCALE_HEIGHT_M = 8000.0
# Middle of the tent, and from there to its ends.
OZONE_MIDDLE_M, OZONE_HALF_WIDTH_M = 25_000.0, 15_000.0
_RAYLEIGH_AT_1_UM = 1.24062e-6
_OZONE_DU = 300.0


def molecules_per_m(wavelength_nm: FloatArray) -> FloatArray:
    """Rayleigh scattering (n,) at sea level, m^-1."""
    return np.asarray(_RAYLEIGH_AT_1_UM * (wavelength_nm / 1000.0) ** -4.0)


def ozone_per_m(wavelength_nm: FloatArray) -> FloatArray:
    """Absorption (n,) by ozone in the middle of its tent, m^-1."""
    return ozone_absorption(wavelength_nm, _OZONE_DU, OZONE_HALF_WIDTH_M)


def ozone_density(altitude_m: ArrayLike) -> FloatArray:
    """Density (...,) of ozone at altitudes (...,), 1 in the middle of its tent."""
    away_m = np.abs(np.asarray(altitude_m, dtype=float) - OZONE_MIDDLE_M)
    return np.maximum(1.0 - away_m / OZONE_HALF_WIDTH_M, 0.0)

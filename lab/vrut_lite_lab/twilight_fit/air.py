"""The air that twilight is computed in: 28 wavelengths, ozone, haze of a given turbidity."""

import math
from dataclasses import replace

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.presets import earth_standard

from vrut_lite.atmosphere.aerosol import ANGSTROM_EXPONENT, optical_depth_of_turbidity
from vrut_lite.numeric_types import FloatArray

# Finer where the eye sees colours; the far red is all that a hazy horizon sends.
WAVELENGTH_NM = np.concatenate([np.arange(400.0, 641.0, 12.0), np.arange(660.0, 781.0, 20.0)])
# Preetham's aerosol scatters 0.9 of what it takes from the light, as the preset's does; its
# forward peak is a little wider.
AEROSOL_G = 0.75
# A mean of land without snow.
GROUND_ALBEDO = 0.2
LOWEST_SUN_DEG = -15.0


def air(turbidity: float, wavelength_nm: FloatArray = WAVELENGTH_NM) -> Atmosphere:
    """The standard air at those wavelengths, with Preetham's aerosol of a turbidity."""
    clear = replace(
        earth_standard(wavelength_nm),
        mu_s_min=math.sin(math.radians(LOWEST_SUN_DEG)),
        ground_albedo=(GROUND_ALBEDO,) * len(wavelength_nm),
    )
    depth = float(optical_depth_of_turbidity(turbidity))
    return clear.with_aerosol(depth, ANGSTROM_EXPONENT, AEROSOL_G)

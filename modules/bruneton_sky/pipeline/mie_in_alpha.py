"""Aerosol's table in the alpha channel of the molecules': what that saves, and what it costs.

The thesis (section 2.3, equation 2.38) keeps of light scattered once by aerosol the first
wavelength only and guesses the others from the molecules' light, as if the two had come
through the same air. From the ground, with the sun low, they have not: all light scattered
once is wrong by up to 27 % in blue with the sun 10 degrees high, 39 % with it on the horizon.
Nothing in this package stores aerosol so; the error tables ask for it.
"""

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from vrut_lite.numeric_types import FloatArray


def mie_from_alpha(
    atmosphere: Atmosphere, single_rayleigh: FloatArray, mie_first: FloatArray
) -> FloatArray:
    """Aerosol's part (..., C), guessed from its first wavelength (...,).

    As equation 2.38 is printed its last ratio is upside down; here it is beta_M / beta_R. No
    light comes of it where the molecules have none at the first wavelength.

    Args:
        single_rayleigh: (..., C); both parts without phase functions.
    """
    rayleigh = np.asarray(atmosphere.rayleigh_scattering)
    mie = np.asarray(atmosphere.mie_scattering)
    first = single_rayleigh[..., 0]
    share = np.divide(mie_first, first, out=np.zeros_like(first), where=first > 0)
    ratio = mie / mie[0] * rayleigh[0] / rayleigh
    return single_rayleigh * share[..., None] * ratio

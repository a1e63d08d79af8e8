"""Turbidity and aerosol optical depth: two scales for the same haze.

Turbidity is Preetham's, related to Angstrom's formula by beta = 0.04608 T - 0.04586
with exponent 1.3 (Preetham, Shirley and Smits 1999, appendix A.1). Turbidity 3 is an optical
depth of 0.20 at 550 nm; Bruneton's demonstration atmosphere, 0.0053, is turbidity 1.05.

Residual: turbidity is *defined* as the optical depth of air and haze over that of air alone.
At 550 nm, with 0.1085 for the air, the definition gives 0.1085 (T - 1); the formula is 7 to 8 %
lower at T >= 2 and within 0.009 below T = 2.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

ANGSTROM_EXPONENT = 1.3
_SLOPE, _OFFSET = 0.04608, -0.04586


def optical_depth_of_turbidity(
    turbidity: ArrayLike, wavelength_nm: ArrayLike = 550.0
) -> NDArray[np.float64]:
    """Vertical aerosol optical depth (...,) at a wavelength in nm; zero for T below 0.9952."""
    at_one_micrometre = np.maximum(_SLOPE * np.asarray(turbidity, dtype=float) + _OFFSET, 0.0)
    micrometre = np.asarray(wavelength_nm, dtype=float) / 1000.0
    return np.asarray(at_one_micrometre * micrometre**-ANGSTROM_EXPONENT)

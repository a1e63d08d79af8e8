"""The aerosol that skies share, and the scales of its amount: optical depth and turbidities.

Turbidity is Preetham's, related to Angstrom's formula by beta = 0.04608 T - 0.04586
with exponent 1.3 (Preetham, Shirley and Smits 1999, appendix A.1). Turbidity 3 is an optical
depth of 0.20 at 550 nm; Bruneton's demonstration atmosphere, 0.0053, is turbidity 1.05.

Residual: turbidity is *defined* as the optical depth of air and haze over that of air alone.
At 550 nm, with 0.1085 for the air, the definition gives 0.1085 (T - 1); the formula is 7 to 8 %
lower at T >= 2 and within 0.009 below T = 2.

Hosek and Wilkie's model needs another turbidity for equal haze: `equal_haze`.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Aerosol of Bruneton's 2017 demonstration: one phase function (Cornette and Shanks) at all
# wavelengths.
ANGSTROM_EXPONENT = 1.3
SINGLE_SCATTERING_ALBEDO = 0.9
ASYMMETRY = 0.8
SCALE_HEIGHT_M = 1200.0
# Turbidities that Preetham's scale and Hosek and Wilkie's model have in common.
LEAST_TURBIDITY, MOST_TURBIDITY = 1.0, 10.0
_SLOPE, _OFFSET = 0.04608, -0.04586
_550_NM_IN_UM = 0.55
# Tolerance of a turbidity, so that a conversion from optical depth and back is exact.
_DECIMALS = 9


def optical_depth_of_turbidity(
    turbidity: ArrayLike, wavelength_nm: ArrayLike = 550.0
) -> NDArray[np.float64]:
    """Vertical aerosol optical depth (...,) at a wavelength in nm; zero for T below 0.9952."""
    at_one_micrometre = np.maximum(_SLOPE * np.asarray(turbidity, dtype=float) + _OFFSET, 0.0)
    micrometre = np.asarray(wavelength_nm, dtype=float) / 1000.0
    return np.asarray(at_one_micrometre * micrometre**-ANGSTROM_EXPONENT)


def turbidity_of_optical_depth(optical_depth_550: float) -> float:
    """Turbidity of a vertical aerosol optical depth at 550 nm; 0.9952 where there is no aerosol."""
    at_one_micrometre = optical_depth_550 * _550_NM_IN_UM**ANGSTROM_EXPONENT
    return round((at_one_micrometre - _OFFSET) / _SLOPE, _DECIMALS)


def cornette_shanks_phase(nu: ArrayLike, g: float) -> NDArray[np.float64]:
    """Cornette and Shanks' 1992 phase function (...,) in sr^-1 of the cosine nu, g in (-1, 1).

    Its mean cosine is 3 g (4 + g^2) / (5 (2 + g^2)), which exceeds g by 5 % at g = 0.8.
    """
    cosine = np.asarray(nu, dtype=float)
    # 1 + g^2 - 2 g nu, written so that it stays positive toward the sun at g near 1.
    spread = (1.0 - g) ** 2 + 2.0 * g * (1.0 - cosine)
    return np.asarray(cornette_shanks_factor(g) * (1.0 + cosine * cosine) / spread**1.5)


def cornette_shanks_factor(g: float) -> float:
    """Factor of (1 + nu^2) / (1 + g^2 - 2 g nu)^1.5, in sr^-1."""
    return float(3.0 / (8.0 * np.pi) * (1.0 - g) * (1.0 + g) / (2.0 + g * g))

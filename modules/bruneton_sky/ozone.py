"""How strongly ozone absorbs light, and how much of it there is."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

DOBSON_UNIT_PER_M2 = 2.687e20
_FIRST_NM, _STEP_NM = 360.0, 10.0
# Absorption cross sections in m^2 from 360 to 830 nm, University of Bremen (Serdyuchenko et
# al. 2011, at 233 K), each the mean of the 10 nm from its wavelength up, in the selection of
# Bruneton's 2017 demonstration.
_CROSS_SECTION_M2 = np.array(
    [
        1.18e-27, 2.182e-28, 2.818e-28, 6.636e-28, 1.527e-27, 2.763e-27, 5.52e-27, 8.451e-27,
        1.582e-26, 2.316e-26, 3.669e-26, 4.924e-26, 7.752e-26, 9.016e-26, 1.48e-25, 1.602e-25,
        2.139e-25, 2.755e-25, 3.091e-25, 3.5e-25, 4.266e-25, 4.672e-25, 4.398e-25, 4.701e-25,
        5.019e-25, 4.305e-25, 3.74e-25, 3.215e-25, 2.662e-25, 2.238e-25, 1.852e-25, 1.473e-25,
        1.209e-25, 9.423e-26, 7.455e-26, 6.566e-26, 5.105e-26, 4.15e-26, 4.228e-26, 3.237e-26,
        2.451e-26, 2.801e-26, 2.534e-26, 1.624e-26, 1.465e-26, 2.078e-26, 1.383e-26, 7.105e-27,
    ]
)  # fmt: skip


def ozone_absorption(
    wavelength_nm: ArrayLike, dobson_units: float, layer_m: float
) -> NDArray[np.float64]:
    """Absorption coefficient (...,) in 1/m where ozone is densest.

    Args:
        wavelength_nm: in nm; outside 360 to 830 nm the nearest value serves.
        dobson_units: of the whole column.
        layer_m: the layer's thickness: the integral over altitude of its relative density.
    """
    nodes_nm = _FIRST_NM + _STEP_NM * np.arange(_CROSS_SECTION_M2.size)
    section_m2 = np.interp(np.asarray(wavelength_nm, dtype=float), nodes_nm, _CROSS_SECTION_M2)
    return np.asarray(section_m2 * dobson_units * DOBSON_UNIT_PER_M2 / layer_m)

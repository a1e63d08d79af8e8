"""Scattering and absorption by gases: molecules by their refractive index, ozone as measured."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

_DOBSON_UNIT_PER_M2 = 2.687e20
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
        dobson_units: ozone of the whole column.
        layer_m: integral over altitude of the layer's relative density.
    """
    nodes_nm = _FIRST_NM + _STEP_NM * np.arange(_CROSS_SECTION_M2.size)
    section_m2 = np.interp(np.asarray(wavelength_nm, dtype=float), nodes_nm, _CROSS_SECTION_M2)
    return np.asarray(section_m2 * dobson_units * _DOBSON_UNIT_PER_M2 / layer_m)


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

"""Scattering by molecules, from a gas's refractive index and how many molecules it has."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


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

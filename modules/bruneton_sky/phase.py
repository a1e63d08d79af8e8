"""Phase functions per steradian: how scattered light spreads over directions."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from vrut_lite.atmosphere.aerosol import cornette_shanks_factor


class MiePhase(NamedTuple):
    """Numbers of either phase function of aerosols, for kernels and shaders without a branch.

    P = factor (1 + form nu^2) / ((1 - g)^2 + 2 g (1 - nu))^1.5 in sr^-1, with form 1 for
    Cornette-Shanks and 0 for Henyey-Greenstein.
    """

    g: float
    factor: float
    form: float


def mie_phase_parameters(atmosphere: Atmosphere) -> MiePhase:
    """The numbers of the atmosphere's aerosol.

    Raises:
        ValueError: its phase function is a table.
    """
    if atmosphere.mie_table is not None:
        raise ValueError("a tabulated phase function has no closed form; use `solve`")
    g = atmosphere.mie_g
    if atmosphere.mie_phase == "henyey-greenstein":
        return MiePhase(g, henyey_greenstein_factor(g), 0.0)
    return MiePhase(g, cornette_shanks_factor(g), 1.0)


def mie_phase(atmosphere: Atmosphere, nu: ArrayLike) -> NDArray[np.float64]:
    """Phase function (...,) in sr^-1 of the atmosphere's aerosol, of the cosine nu."""
    cosine = np.asarray(nu, dtype=float)
    g, factor, form = mie_phase_parameters(atmosphere)
    return np.asarray(factor * (1.0 + form * cosine * cosine) / _spread(cosine, g) ** 1.5)


def particles_phase(atmosphere: Atmosphere, name: str, nu: ArrayLike) -> NDArray[np.float64]:
    """Phase function (..., C) in sr^-1 of a kind of particles: see `Atmosphere.table_of`."""
    table = atmosphere.table_of(name)
    if table is not None:
        return table(nu)
    one = mie_phase(atmosphere, nu)[..., None]
    return np.broadcast_to(one, (*one.shape[:-1], len(atmosphere.wavelength_nm)))


def particles_polarisation(
    atmosphere: Atmosphere, name: str, nu: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """P12 / P11 and P33 / P11 (..., C) of the same; a closed form keeps polarisation and makes
    none: 0 and 1. Where P12 is negative light vibrates across the scattering plane."""
    table = atmosphere.table_of(name)
    if table is not None:
        return table.polarisation(nu)
    shape = *np.shape(nu), len(atmosphere.wavelength_nm)
    return np.zeros(shape), np.ones(shape)


def rayleigh_phase(nu: ArrayLike) -> NDArray[np.float64]:
    """Rayleigh's phase function (...,) in sr^-1, of the cosine nu of the scattering angle.

    Tables and volumes of air divide the molecules' light by it, whatever their depolarisation.
    """
    cosine = np.asarray(nu, dtype=float)
    return np.asarray(3.0 / (16.0 * np.pi) * (1.0 + cosine * cosine))


def molecules_phase(atmosphere: Atmosphere, nu: ArrayLike) -> NDArray[np.float64]:
    """The same of the atmosphere's molecules, which depolarise."""
    dipoles = atmosphere.rayleigh_anisotropy
    return np.asarray(dipoles * rayleigh_phase(nu) + (1.0 - dipoles) / (4.0 * np.pi))


def molecules_polarisation(atmosphere: Atmosphere, nu: ArrayLike) -> NDArray[np.float64]:
    """P12 / P11 (...,) of the atmosphere's molecules (Hansen and Travis 1974, equation 2.15)."""
    cosine, dipoles = np.asarray(nu, dtype=float), atmosphere.rayleigh_anisotropy
    across = -3.0 / (16.0 * np.pi) * dipoles * (1.0 - cosine) * (1.0 + cosine)
    return np.asarray(across / molecules_phase(atmosphere, cosine))


def henyey_greenstein_phase(nu: ArrayLike, g: float) -> NDArray[np.float64]:
    """Henyey and Greenstein's 1941 phase function (...,) in sr^-1, mean cosine g in (-1, 1)."""
    return np.asarray(henyey_greenstein_factor(g) / _spread(np.asarray(nu, dtype=float), g) ** 1.5)


def henyey_greenstein_factor(g: float) -> float:
    """Factor of 1 / (1 + g^2 - 2 g nu)^1.5, in sr^-1."""
    return float((1.0 - g) * (1.0 + g) / (4.0 * np.pi))


def _spread(nu: NDArray[np.float64], g: float) -> NDArray[np.float64]:
    """1 + g^2 - 2 g nu, written so that it stays positive toward the sun at g near 1."""
    return np.asarray((1.0 - g) ** 2 + 2.0 * g * (1.0 - nu))

"""Phase functions per steradian: how scattered light spreads over directions."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def rayleigh_phase(nu: ArrayLike) -> NDArray[np.float64]:
    """Rayleigh's phase function (...,) in sr^-1, of the cosine nu of the scattering angle."""
    cosine = np.asarray(nu, dtype=float)
    return np.asarray(3.0 / (16.0 * np.pi) * (1.0 + cosine * cosine))


def cornette_shanks_phase(nu: ArrayLike, g: float) -> NDArray[np.float64]:
    """Cornette and Shanks' 1992 phase function (...,) in sr^-1, asymmetry g in (-1, 1).

    The denominator is (1 - g)^2 + 2 g (1 - nu): it stays positive where 1 + g^2 - 2 g nu
    would cancel, toward the sun at g near 1.
    """
    cosine = np.asarray(nu, dtype=float)
    spread = (1.0 - g) ** 2 + 2.0 * g * (1.0 - cosine)
    return np.asarray(cornette_shanks_factor(g) * (1.0 + cosine * cosine) / spread**1.5)


def cornette_shanks_factor(g: float) -> float:
    """What (1 + nu^2) / (1 + g^2 - 2 g nu)^1.5 is multiplied by, in sr^-1."""
    return float(3.0 / (8.0 * np.pi) * (1.0 - g) * (1.0 + g) / (2.0 + g * g))

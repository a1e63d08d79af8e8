"""Scattering as a convolution: spherical harmonics about the zenith, even in azimuth.

Light that arrives at a point as L(direction) leaves it, scattered, as the integral of
P(cosine) L. In spherical harmonics that multiplies each coefficient of degree l by
chi_l = 2 pi integral P(x) P_l(x) dx (the Funk-Hecke theorem). chi_0 = 1, so that scattering
conserves energy exactly, whatever the number of directions.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray

_GAUSS_POINTS = 512


def legendre(order: int, degree: int, mu: ArrayLike) -> FloatArray:
    """Functions (degree - order + 1, ...) whose products with cos(order * phi) are orthonormal.

    Degrees from `order` to `degree`; on the sphere, with the azimuth's factor of 2 for
    order > 0 contained. The three-term recurrence in the degree is stable.
    """
    x = np.asarray(mu, dtype=float)
    sine = np.sqrt(np.maximum((1.0 - x) * (1.0 + x), 0.0))
    first = np.full_like(x, np.sqrt((1.0 if order == 0 else 2.0) / (4.0 * np.pi)))
    for m in range(1, order + 1):
        first = first * sine * np.sqrt((2.0 * m + 1.0) / (2.0 * m))
    rows = [first, x * np.sqrt(2.0 * order + 3.0) * first]
    for l in range(order + 2, degree + 1):  # noqa: E741
        scale = np.sqrt((4.0 * l * l - 1.0) / (l * l - order * order))
        below = np.sqrt(((l - 1.0) ** 2 - order * order) / (4.0 * (l - 1.0) ** 2 - 1.0))
        rows.append(scale * (x * rows[-1] - below * rows[-2]))
    return np.stack(rows[: degree - order + 1])


def phase_coefficients(phase: Callable[[FloatArray], FloatArray], degree: int) -> FloatArray:
    """chi_l (degree + 1,) of a phase function of the cosine, normalised so that chi_0 = 1."""
    x, w = _gauss()
    legendre_p = np.polynomial.legendre.legvander(x, degree)
    chi = 2.0 * np.pi * (w * phase(x)) @ legendre_p
    return np.asarray(chi / chi[0])


@lru_cache(maxsize=1)
def _gauss() -> tuple[FloatArray, FloatArray]:
    return np.polynomial.legendre.leggauss(_GAUSS_POINTS)

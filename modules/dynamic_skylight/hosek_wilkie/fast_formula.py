"""The form of the formula that the fast paths on CPU and GPU evaluate.

Polynomials replace the angle and the exponential. The numbers A to I are combined in double
precision, so that single precision does not suffer from cancellation:

* the angle from the sun comes from the chord u = |d - s|^2 = 2 - 2 cos gamma, summed from
  differences of components, not from cos gamma, which is flat at the sun;
* chi's denominator 1 + I^2 - 2 I cos gamma is (1 - I)^2 + I u;
* C + D exp(E gamma), where C and D reach 50 with opposite signs, is (C + D) + D expm1(E gamma),
  with C + D formed in float64; 1 + A exp(...) likewise.
"""

from collections.abc import Callable

import numpy as np

from vrut_lite.numeric_types import Float32Array, FloatArray


def _fit(
    function: Callable[[FloatArray], FloatArray], lower: float, upper: float, degree: int
) -> tuple[np.float32, ...]:
    """Power coefficients, constant first, of a polynomial fitted at Chebyshev nodes."""
    fit = np.polynomial.Chebyshev.interpolate(function, degree, domain=[lower, upper])
    return tuple(fit.convert(kind=np.polynomial.Polynomial).coef.astype(np.float32))


def _angle_over_chord(u: FloatArray) -> FloatArray:
    return 2.0 * np.arcsin(np.sqrt(u) / 2.0) / np.sqrt(u)


def _exp2m1_over_x(x: FloatArray) -> FloatArray:
    limit = np.full_like(x, np.log(2.0))
    return np.divide(np.expm1(np.log(2.0) * x), x, out=limit, where=x != 0.0)


# Relative errors of both: below 2e-7, about float32's own.
ANGLE_POLYNOMIAL = _fit(_angle_over_chord, 0.0, 2.0, 6)
EXP2M1_POLYNOMIAL = _fit(_exp2m1_over_x, -0.5, 0.5, 4)


def fold(distribution: FloatArray, mean_radiance: FloatArray) -> Float32Array:
    """Eleven numbers per colour (3, 11): R(1+A), RA, B', C+D, D, E', F, G, (1-I)^2, I, H.

    B' and E' are B and E over ln 2, for powers of two instead of e.
    """
    A, B, C, D, E, F, G, H, I = distribution.T  # noqa: E741 (the paper's letters)
    R, log2_e = mean_radiance, 1.0 / np.log(2.0)
    folded = [R * (1 + A), R * A, B * log2_e, C + D, D, E * log2_e, F, G, (1 - I) ** 2, I, H]
    return np.array(folded).T.astype(np.float32, order="C")

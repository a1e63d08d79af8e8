"""The extended Perez formula of Hosek and Wilkie 2012, equations 8 and 9."""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray

# Keeps the horizon's gradient finite; part of the published formula.
HORIZON_OFFSET = 0.01


def extended_perez(
    cos_theta: ArrayLike, gamma_rad: ArrayLike, parameters: FloatArray
) -> FloatArray:
    """Radiance relative to the mean (..., C) at zenith angles and angles from the sun (...,).

    `parameters` (C, 9) are A to I as `coefficients.sky_formula` returns them. cos_theta
    lies in [0, 1]. The chi in the paper's equation 9 has its denominator to the power 3/2.
    """
    c, g = np.broadcast_arrays(
        np.asarray(cos_theta, dtype=float)[..., None], np.asarray(gamma_rad, dtype=float)[..., None]
    )
    A, B, C, D, E, F, G, H, I = parameters.T  # noqa: E741 (the paper's letters)
    cos_gamma = np.cos(g)
    zenith = 1.0 + A * np.exp(B / (c + HORIZON_OFFSET))
    return zenith * (
        C + D * np.exp(E * g) + F * cos_gamma**2 + G * chi(I, cos_gamma) + H * np.sqrt(c)
    )


def chi(anisotropy: ArrayLike, cos_gamma: ArrayLike) -> FloatArray:
    """The aureole (1 + cos^2 g) / (1 + I^2 - 2 I cos g)^(3/2)."""
    i, x = np.asarray(anisotropy, dtype=float), np.asarray(cos_gamma, dtype=float)
    return (1.0 + x * x) / (1.0 + i * i - 2.0 * i * x) ** 1.5

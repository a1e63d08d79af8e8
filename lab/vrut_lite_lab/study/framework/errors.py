"""Errors of a model's sky against the measured one, at the 81 directions, 360 to 720 nm.

RMSE is dominated by the bright sky around the sun; relative errors show the other directions.
After Bruneton 2016, section 5.
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.colour import approximate_spectrum
from vrut_lite_lab.study.framework.spectra import COMMON_NM, WAVELENGTHS_NM, integral_between

IN_COMMON = slice(0, int(np.searchsorted(WAVELENGTHS_NM, COMMON_NM[1])))


def rmse(model: ArrayLike, measured: ArrayLike) -> FloatArray:
    """Root mean square difference (...,) of radiances (..., 81, 40), in their unit.

    Over the 81 directions and the 31 wavelengths below 720 nm.
    """
    difference = np.asarray(model, dtype=float) - np.asarray(measured, dtype=float)
    return np.sqrt((difference[..., IN_COMMON] ** 2).mean(axis=(-1, -2)))


def total_rmse(each: ArrayLike) -> float:
    """The RMSE over several times, from that of each (times,)."""
    return float(np.sqrt(np.mean(np.square(np.asarray(each, dtype=float)))))


def relative_error(model: ArrayLike, measured: ArrayLike) -> FloatArray:
    """Model over measured, less 1, (...,) of radiances (..., 40) integrated from 360 to 720 nm."""
    seen = integral_between(measured, *COMMON_NM)
    return np.asarray((integral_between(model, *COMMON_NM) - seen) / seen)


def relative_rmse(model: ArrayLike, truth: ArrayLike) -> FloatArray:
    """Root mean square (...,) of the pointwise relative difference of radiances (..., 81, 40).

    Over the directions and wavelengths of `rmse`; the truth must be nowhere zero.
    """
    right = np.asarray(truth, dtype=float)[..., IN_COMMON]
    ratio = np.asarray(model, dtype=float)[..., IN_COMMON] / right
    return np.sqrt(((ratio - 1.0) ** 2).mean(axis=(-1, -2)))


def approximate_spectrum_rmse(model: ArrayLike, measured: ArrayLike) -> FloatArray:
    """`rmse` (...,) after the model's spectra were rebuilt from three of their samples."""
    return rmse(approximate_spectrum(model), measured)

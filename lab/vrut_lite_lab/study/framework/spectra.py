"""Spectra of the evaluation: 40 numbers, one for each bin of 11.75 nm, 360 to 830 nm.

After Bruneton 2016, "A Qualitative and Quantitative Evaluation of 8 Clear Sky Models". A number
belongs to its bin's left edge; between two of them a spectrum is linear, outside it is constant;
integrals take it as constant in each bin.
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray

FIRST_NM, LAST_NM, COUNT = 360.0, 830.0, 40
BIN_NM = (LAST_NM - FIRST_NM) / COUNT
WAVELENGTHS_NM: FloatArray = FIRST_NM + BIN_NM * np.arange(COUNT, dtype=np.float64)
WAVELENGTHS_NM.flags.writeable = False
# All models know this range, so errors are summed over it: Hosek and Wilkie's ends at 720 nm.
COMMON_NM = (360.0, 720.0)


def resampled(wavelength_nm: ArrayLike, values: ArrayLike) -> FloatArray:
    """A table (..., n) at increasing wavelengths (n,) in nm as a spectrum (..., 40).

    Linear between the table's wavelengths, constant beyond them.
    """
    nodes = np.asarray(wavelength_nm, dtype=float)
    return linear(np.asarray(values, dtype=float), nodes, WAVELENGTHS_NM)


def at_wavelength(spectrum: ArrayLike, wavelength_nm: ArrayLike) -> FloatArray:
    """A spectrum (..., 40) at wavelengths (n,) in nm: (..., n)."""
    wanted = np.atleast_1d(np.asarray(wavelength_nm, dtype=float))
    return linear(np.asarray(spectrum, dtype=float), WAVELENGTHS_NM, wanted)


def linear(values: FloatArray, nodes: FloatArray, wanted: FloatArray) -> FloatArray:
    """Values (..., n) at increasing nodes (n,) at the wanted (m,): (..., m), held at the ends."""
    position = np.interp(wanted, nodes, np.arange(nodes.size))
    low = np.minimum(position.astype(int), nodes.size - 2)
    part = position - low
    return np.asarray(values[..., low] * (1.0 - part) + values[..., low + 1] * part)


def integral(spectrum: ArrayLike) -> FloatArray:
    """Integral (...,) of spectra (..., 40) over all 470 nm."""
    return np.asarray(BIN_NM * np.asarray(spectrum, dtype=float).sum(axis=-1))


def integral_between(spectrum: ArrayLike, start_nm: float, end_nm: float) -> FloatArray:
    """Integral (...,) of spectra (..., 40) from start to end in nm, constant in each bin."""
    right_nm = np.minimum(WAVELENGTHS_NM + BIN_NM, end_nm)
    width_nm = np.maximum(right_nm - np.maximum(WAVELENGTHS_NM, start_nm), 0.0)
    return np.asarray(np.asarray(spectrum, dtype=float) @ width_nm)

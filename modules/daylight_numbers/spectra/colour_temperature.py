"""Correlated colour temperature and Duv: the nearest point of Planck's locus in CIE 1960 (u, v).

As Ohno 2013, "Practical Use and Calculation of CCT and Duv", but on a table each half mired, so
fine that the nearest point of its polyline is within 0.5 K up to 20,000 K.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from daylight_numbers.spectra.eye_responses import response_matrix
from vrut_lite.numeric_types import FloatArray

# m K, of ITS-90, with which CIE 15 defines colour temperatures.
_C2_NM_K = 1.4388e7
_MIRED = np.arange(1.0, 1000.25, 0.5)
# Distance beyond which CIE 15 has no correlated colour temperature.
FARTHEST_DUV = 0.05
_AT_ONCE = 4096


class ColourTemperature(NamedTuple):
    """Correlated colour temperature (...,) in K, and distance (...,) from Planck's locus in (u, v),
    above 0 on its green side; nan for no light, and without one of these by CIE 15."""

    cct_k: FloatArray
    duv: FloatArray


def colour_temperature(xyz: ArrayLike) -> ColourTemperature:
    """Colour temperature of tristimulus values (..., 3), from 1,000 to 1,000,000 K."""
    found = np.asarray(xyz, float)
    weight = found @ np.array([1.0, 15.0, 3.0])
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v = 4.0 * found[..., 0] / weight, 6.0 * found[..., 1] / weight
    places = np.stack([u, v], axis=-1).reshape(-1, 2)
    mired, duv = np.full((2, len(places)), np.nan)
    for first in range(0, len(places), _AT_ONCE):
        some = slice(first, first + _AT_ONCE)
        mired[some], duv[some] = _nearest(places[some])
    far = ~(np.abs(duv) <= FARTHEST_DUV) | (mired <= _MIRED[0]) | (mired >= _MIRED[-1])
    kelvin = np.where(far, np.nan, 1e6 / mired)
    duv = np.where(far, np.nan, duv)
    return ColourTemperature(kelvin.reshape(u.shape), duv.reshape(u.shape))


def _nearest(places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Mired (n,) and signed distance (n,) of the nearest points of the locus."""
    locus = _locus()
    start, along = locus[:-1], np.diff(locus, axis=0)
    away = places[:, None] - start
    share = np.einsum("nki,ki->nk", away, along) / np.einsum("ki,ki->k", along, along)
    offset = away - np.clip(share, 0.0, 1.0)[..., None] * along
    distance = np.hypot(offset[..., 0], offset[..., 1])
    known = np.isfinite(distance).all(axis=1)
    segment = np.where(known, np.argmin(np.where(known[:, None], distance, 0.0), axis=1), 0)
    row = np.arange(len(places))
    at = np.clip(share[row, segment], 0.0, 1.0)
    mired = _MIRED[segment] + at * (_MIRED[1] - _MIRED[0])
    # Along the locus mired rise to the red: green lies on the left of it, v upwards.
    side = along[segment, 0] * away[row, segment, 1] - along[segment, 1] * away[row, segment, 0]
    return np.where(known, mired, np.nan), np.sign(side) * distance[row, segment]


@lru_cache(maxsize=1)
def _locus() -> FloatArray:
    """Planck's locus (n, 2) in (u, v) at `_MIRED`."""
    nm = np.arange(360.0, 831.0)
    kelvin = 1e6 / _MIRED[:, None]
    # Relative to 560 nm, so that nothing overflows.
    exponent = _C2_NM_K / kelvin * (1.0 / nm - 1.0 / 560.0)
    full = _C2_NM_K / (nm * kelvin)
    planck = nm**-5.0 * np.exp(-exponent) / (-np.expm1(-full))
    x, y, z = (planck @ response_matrix(tuple(nm.tolist()))[:, :3]).T
    return np.stack([4.0 * x, 6.0 * y], axis=-1) / (x + 15.0 * y + 3.0 * z)[:, None]

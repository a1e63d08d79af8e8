"""Coefficients of the sun's places in few bytes: whole steps, as differences from place to place.

Steps leave the same noise in the light of each term: the first basis map of a cluster takes eleven
bits and most others three or four. Low and high bytes stand apart, for gzip has no symbols of two
bytes.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import Float32Array, FloatArray

# Steps in the rms of a cluster's first coefficient.
_STEPS = 2048.0
# Least rms of a term's values that counts: few texels of a cluster have the weakest terms.
_LEAST_SPREAD = 0.25
_MOST = 32767.0


class SunCoefficients(NamedTuple):
    """Coefficients of S places, C clusters and K terms, for three channels.

    `codes` (2, S, C, K, 3) uint8: low and high bytes of differences to the place before, with their
    sign in the lowest bit; `step` (C, K) float32: the coefficient of a whole.
    """

    codes: NDArray[np.uint8]
    step: Float32Array

    def decoded(self) -> Float32Array:
        """The coefficients (S, C, K, 3): the twin of the page's sum in `light.js`."""
        low, high = self.codes.astype(np.int32)
        folded = low + 256 * high
        whole = np.where(folded & 1, -(folded >> 1) - 1, folded >> 1).cumsum(axis=0)
        return np.asarray(whole * self.step[..., None], np.float32)


def sun_coefficients(values: Float32Array, spread: FloatArray) -> SunCoefficients:
    """The codes of coefficients (S, C, K, 3) of terms whose values have an rms `spread` (C, K)."""
    peak = np.abs(values).max(axis=(0, 3), initial=0.0)
    first = np.sqrt(np.square(np.abs(values[:, :, 0]).max(axis=2, initial=0.0)).mean(axis=0))
    counted = np.maximum(spread, _LEAST_SPREAD)
    # Differences of two wholes must fit into two bytes.
    step = np.maximum((first * counted[:, 0])[:, None] / (_STEPS * counted), peak * (2.0 / _MOST))
    step = np.maximum(step, 1e-30).astype(np.float32)
    whole = np.rint(values / step[..., None]).astype(np.int32)
    change = np.diff(whole, axis=0, prepend=0)
    folded = np.where(change < 0, -2 * change - 1, 2 * change)
    return SunCoefficients(np.stack([folded & 255, folded >> 8]).astype(np.uint8), step)

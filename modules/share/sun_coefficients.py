"""Coefficients of the sun's places in few bytes: whole steps, as differences from place to place.

A step is a share of a cluster's first coefficient, which leaves 0.2 % of the light as noise. The
first basis map takes eleven bits then and most others three or four; low and high bytes stand
apart, for gzip has no symbols of two bytes. All of them take 0.43 of float16's size.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import Float32Array

# Steps in the rms of a cluster's first coefficient.
_STEPS = 1024.0
_MOST = 32767.0


class SunCoefficients(NamedTuple):
    """Coefficients of S places, C clusters and K terms, for three channels.

    `codes` (2, S, C, K, 3) uint8: low and high bytes of differences to the place before, with their
    sign in the lowest bit; `step` (C,) float32: the coefficient of a whole.
    """

    codes: NDArray[np.uint8]
    step: Float32Array

    def decoded(self) -> Float32Array:
        """The coefficients (S, C, K, 3): the twin of the page's sum in `light.js`."""
        low, high = self.codes.astype(np.int32)
        folded = low + 256 * high
        whole = np.where(folded & 1, -(folded >> 1) - 1, folded >> 1).cumsum(axis=0)
        return np.asarray(whole * self.step[:, None, None], np.float32)


def sun_coefficients(values: Float32Array) -> SunCoefficients:
    """The codes of coefficients (S, C, K, 3)."""
    peak = np.abs(values).max(axis=(0, 2, 3), initial=0.0)
    first = np.square(np.abs(values[:, :, 0]).max(axis=2, initial=0.0))
    # Differences of two wholes must fit into two bytes.
    step = np.maximum(np.sqrt(first.mean(axis=0)) / _STEPS, peak * (2.0 / _MOST))
    step = np.maximum(step, 1e-30).astype(np.float32)
    whole = np.rint(values / step[:, None, None]).astype(np.int32)
    change = np.diff(whole, axis=0, prepend=0)
    folded = np.where(change < 0, -2 * change - 1, 2 * change)
    return SunCoefficients(np.stack([folded & 255, folded >> 8]).astype(np.uint8), step)

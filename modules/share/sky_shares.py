"""Share of the open sky's light that arrives at a light map's values, by the sun's place.

It is a mean over the day's places times a ratio, whose principal components are kept: windows that
face the bright part of the sky let in more of it. Errors count by the share itself, up to a third.
Components are bytes, finer around 0: sign(b) |b / 127|^1.5.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from share.components import principal
from vrut_lite.numeric_types import Float32Array, FloatArray

COMPONENTS = 24
# Code of a mean share of 1.
MEAN_CODES = 65535.0
# Exponent of the bytes.
POWER = 1.5
_MOST = 127.0
# Shares above which errors count no more, and below which there is no ratio.
_FULL, _LEAST = 0.3, 1e-4
# Smallest ratio: where no share is left no sunlight is drawn.
LEAST_RATIO = 0.02
# Rms ratio less 1 over the places, above which components are cut: few texels, with hardly any sky,
# would make the bytes of all others coarse.
_MOST_RATIO = 2.0


@dataclass(frozen=True, eq=False)
class SkyShares:
    """Shares of T values under a sun in S places.

    Attributes:
        mean: (T,) over the places of day.
        components: (`COMPONENTS`, T) int8, of the ratio to the mean less 1.
        weights: (S, `COMPONENTS`) float32, of the components' values (`decoded`).
    """

    mean: Float32Array
    components: NDArray[np.int8]
    weights: Float32Array

    def of(self, weights: FloatArray | Float32Array) -> Float32Array:
        """Shares (T,) by weights (`COMPONENTS`,): the twin of the page's sum."""
        ratio = 1.0 + weights.astype(np.float32) @ decoded(self.components)
        return np.asarray(self.mean * np.maximum(ratio, LEAST_RATIO), np.float32)


def decoded(codes: NDArray[np.int8]) -> Float32Array:
    """Values of bytes."""
    share = np.abs(codes.astype(np.float32)) / np.float32(_MOST)
    return np.asarray(np.sign(codes) * share ** np.float32(POWER), np.float32)


def coded(values: Float32Array) -> tuple[NDArray[np.int8], Float32Array]:
    """Bytes of components (K, T) over the peaks (K,) of their values, and the peaks."""
    peak = np.maximum(np.abs(values).max(axis=1), np.float32(1e-30))
    share = (np.abs(values) / peak[:, None]) ** (1.0 / POWER)
    return (np.sign(values) * np.rint(_MOST * share)).astype(np.int8), peak


def mean_codes(mean: Float32Array) -> NDArray[np.uint16]:
    """Codes of mean shares, even in their roots: steps of a byte show on walls deep inside."""
    return np.rint(MEAN_CODES * np.sqrt(np.clip(mean, 0.0, 1.0))).astype(np.uint16)


def sky_shares(by_sun: NDArray[np.floating], is_day: NDArray[np.bool_]) -> SkyShares:
    """The components of shares (S, T); `is_day` (S,) are the mean's places."""
    shares = by_sun.astype(np.float32)
    mean = shares[is_day].mean(axis=0) if is_day.any() else shares.mean(axis=0)
    # Components make up for the rounding of the mean.
    mean = np.asarray((mean_codes(mean) / MEAN_CODES) ** 2, np.float32)
    has_ratio = mean > _LEAST
    weight = np.minimum(mean, np.float32(_FULL))
    rows = np.where(has_ratio, shares / np.maximum(mean, _LEAST) - 1.0, 0.0) * weight
    along = principal(rows @ rows.T, COMPONENTS)
    values = np.where(has_ratio, (along.T @ rows) / np.maximum(weight, 1e-9), 0.0)
    bound = _MOST_RATIO * np.sqrt(len(shares))
    values = np.clip(values, -bound, bound)
    missing = COMPONENTS - len(values)
    values = np.pad(values, ((0, missing), (0, 0)))
    codes, peak = coded(values)
    weights = np.pad(along, ((0, 0), (0, missing))) * peak
    return SkyShares(mean, codes, weights.astype(np.float32))

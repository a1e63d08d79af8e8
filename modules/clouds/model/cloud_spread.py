"""How much weather and noise of a `CloudLayer` vary within the width of a sample.

A sample as wide as a pixel far away takes in clouds and gaps. It knows its mean weather and noise,
from levels of means, and by this their spread about the means, which is the same everywhere: the
variance of the whole less that of the means.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.numeric_types import FloatArray

# Widths at which the spread is known: 1 m, and each twice the one before. What is nearly nothing or
# nearly all says nothing of the width.
_WIDTHS_M = 2.0 ** np.arange(24)
_TOLD, _NONE = 0.02, 1e-6


class CloudSpread(NamedTuple):
    """Standard deviations of weather and noise within a width: most / (1 + (half_m / width)^power).

    The noise is the shape less the detail times the form's `fraying`. Each (2,), weather first;
    `log_half` is the binary logarithm of half_m.
    """

    most: tuple[float, float]
    log_half: tuple[float, float]
    power: tuple[float, float]


def spread_of(layer: CloudLayer) -> CloudSpread:
    """The spread fitted to that of the layer's maps, about 0.01."""
    form = layer.form
    first, second = (_variance(layer.weather, period) for period in form.weather_periods_m)
    weather = (1.0 - form.second_share) ** 2 * first + form.second_share**2 * second
    shape = _variance(layer.shape, form.shape_period_m)
    noise = shape + form.fraying**2 * _variance(layer.detail, form.detail_period_m)
    fits = [_fitted(np.sqrt(variance)) for variance in (weather, noise)]
    most, log_half, power = zip(*fits, strict=True)
    return CloudSpread(most, log_half, power)


def _fitted(deviations: FloatArray) -> tuple[float, float, float]:
    """The numbers of a spread known at `_WIDTHS_M`."""
    most = float(deviations[-1])
    share = deviations / max(most, _NONE)
    told = (share > _TOLD) & (share < 1.0 - _TOLD)
    if most < _NONE or told.sum() < 2:
        return 0.0, 0.0, 1.0
    logs = np.log2(_WIDTHS_M)[told]
    power, offset = np.polyfit(logs, np.log2(share[told] / (1.0 - share[told])), 1)
    return most, float(-offset / power), float(power)


def _variance(noise: Array, period_m: float) -> FloatArray:
    """Variance of a noise within `_WIDTHS_M`."""
    levels = _variances(noise)
    lods = np.log2(_WIDTHS_M * (noise.values.shape[0] / period_m))
    return np.asarray(np.interp(lods, np.arange(len(levels)), levels))


@lru_cache(maxsize=16)
def _variances(noise: Array) -> FloatArray:
    """Variance (levels,) within the texels of each level of means."""
    means = [level.astype(float).var() for level in halved(noise.values)]
    return np.asarray(means[0] - np.array(means))


def halved(noise: NDArray) -> list[NDArray[np.float32]]:
    """A noise in [0, 1], its means over 2 texels along each axis, and so on to an odd edge."""
    level = (noise / np.float32(np.iinfo(noise.dtype).max)).astype(np.float32)
    levels = [level]
    while len(level) % 2 == 0:
        half = len(level) // 2
        pairs = level.reshape([edge for _ in level.shape for edge in (half, 2)])
        level = pairs.mean(axis=tuple(range(1, pairs.ndim, 2)), dtype=np.float32)
        levels.append(level)
    return levels

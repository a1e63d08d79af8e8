"""Histogram of a picture's luminance by stops, by which a picture that stays on a card is metered.

Bins are narrow: metering by a histogram differs by less than 0.01 EV from metering by pixels.
`render/shaders/luminance_histogram.comp` counts on the card, `counted` is its twin.
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import luminance

# From below starlit ground to above the sun's disc (log2 of W m^-2 sr^-1).
LEAST_LOG2, MOST_LOG2 = -24.0, 26.0
BINS_PER_STOP = 64
BINS = int((MOST_LOG2 - LEAST_LOG2) * BINS_PER_STOP)
# Representative pixels of a histogram: as many as meter a moving picture (`adaptation`).
_PIXELS = 2**13


def counted(radiance_rgb: NDArray[np.floating]) -> NDArray[np.uint32]:
    """Counts (BINS,) of the finite pixels of radiance (..., 3); the end bins take all beyond."""
    values = luminance(radiance_rgb).ravel()
    values = values[np.isfinite(values)]
    stops = np.log2(np.maximum(values, 2.0**LEAST_LOG2))
    bins = np.floor((stops - LEAST_LOG2) * BINS_PER_STOP).astype(int)
    return np.bincount(np.clip(bins, 0, BINS - 1), minlength=BINS).astype(np.uint32)


def luminances_of(counts: NDArray[np.integer], pixels: int = _PIXELS) -> NDArray[np.float64]:
    """Luminances (pixels,), ascending, distributed as the counts; none of an empty picture."""
    below = np.cumsum(counts, dtype=np.int64)
    if below[-1] == 0:
        return np.empty(0)
    ranks = (np.arange(pixels) + 0.5) / pixels * below[-1]
    bins = np.searchsorted(below, ranks, side="right")
    return np.asarray(2.0 ** (LEAST_LOG2 + (bins + 0.5) / BINS_PER_STOP))

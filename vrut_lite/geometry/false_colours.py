"""Values as colours, on a scale of ratios or of even steps; the colours are perceptually even."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray

AnyFloats = NDArray[np.floating]

# Colours from dark violet over green to yellow.
_STOPS = np.array(
    [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]], float
)
UNUSED = (24, 24, 24)
# Range of the shown values: darker and brighter ones get the colours of the ends.
_LOW, _HIGH = 0.01, 0.99
_WIDEST = 1e3
# Iso-lines are at these times a power of ten, at most a few.
_ROUND = (1.0, 2.0, 3.0, 5.0, 7.5)
_MOST_LINES = 6
_LEAST = 1e-12


class Scale(NamedTuple):
    """Values of the darkest and of the brightest colour; 0 without values.

    `from_zero`: colours follow values in even steps from 0, not their ratios.
    """

    low: float
    high: float
    from_zero: bool = False

    def at(self, share: float) -> float:
        """The value at a share of the way from the darkest colour to the brightest."""
        if self.from_zero:
            return share * self.high
        return float(self.low ** (1.0 - share) * self.high**share)

    def shares(self, values: AnyFloats) -> FloatArray:
        """Shares of that way at which positive values stand, in the shape of `values`."""
        if self.from_zero:
            return np.asarray(values / self.high)
        span = max(np.log(self.high / self.low), 1e-9)
        return np.asarray(np.log(np.maximum(values, self.low) / self.low) / span)


def scale_of(values: AnyFloats, from_zero: bool = False) -> Scale:
    """A scale for values of any shape; only positive numbers count."""
    used = values[np.isfinite(values) & (values > 0.0)]
    if not len(used):
        return Scale(0.0, 0.0)
    if from_zero:
        return Scale(0.0, float(used.max()), from_zero)
    low, high = (float(value) for value in np.quantile(used, (_LOW, _HIGH)))
    return Scale(max(low, high / _WIDEST), high)


def coloured(values: AnyFloats, scale: Scale) -> NDArray[np.uint8]:
    """sRGB pixels (..., 3) of values (...,); UNUSED where a value is not a positive number, or 0
    on a scale from 0."""
    pixels = np.empty((*values.shape, 3), np.uint8)
    pixels[:] = UNUSED
    used = np.isfinite(values) & ((values > 0.0) | (scale.from_zero & (values == 0.0)))
    if scale.high > 0.0:
        pixels[used] = colours_at(np.clip(scale.shares(values[used]), 0.0, 1.0))
    return pixels


def round_levels(scale: Scale) -> FloatArray:
    """Round values within a scale, rising, at which iso-lines are drawn."""
    if scale.high <= 0.0:
        return np.empty(0)
    tens = np.arange(np.floor(np.log10(scale.low)), np.ceil(np.log10(scale.high)) + 1)
    ladder = np.array([step * 10.0**ten for ten in tens for step in _ROUND])
    found = ladder[(ladder > scale.low) & (ladder < scale.high)]
    return found[:: max(1, -(-len(found) // _MOST_LINES))]


def iso_lines(values: AnyFloats, levels: FloatArray, steepest: float = np.inf) -> NDArray[np.int64]:
    """Number of the level that values (h, w) pass at each pixel from the left or from above.

    -1 elsewhere, also beside nan and where the ratio of neighbours exceeds `steepest`, at the edge
    of an object.
    """
    found = np.full(values.shape, -1)
    level = np.searchsorted(levels, values)
    for here, before in (
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
        ((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
    ):
        low, high = np.fmin(values[here], values[before]), np.fmax(values[here], values[before])
        both = np.isfinite(values[here]) & np.isfinite(values[before])
        near = high <= steepest * np.maximum(low, _LEAST)
        passes = both & near & (level[here] != level[before])
        number = np.maximum(level[here], level[before]) - 1
        found[here] = np.where(passes, number, found[here])
    return found


def scale_pixels(width: int) -> NDArray[np.uint8]:
    """The scale (1, width, 3) from the darkest colour to the brightest."""
    return colours_at(np.linspace(0.0, 1.0, width)[None])


def colours_at(share: FloatArray) -> NDArray[np.uint8]:
    """sRGB pixels (..., 3) at shares (...,) of the way from the darkest colour to the brightest."""
    at = share * (len(_STOPS) - 1)
    rgb = np.stack([np.interp(at, range(len(_STOPS)), stops) for stops in _STOPS.T], axis=-1)
    return rgb.round().astype(np.uint8)

"""Density of a gas whose scale height changes from layer to layer: the form of standard
atmospheres."""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray


class ExponentialLayers(NamedTuple):
    """A continuous relative density, 1 at altitude 0: share * exp(-altitude / scale height) in
    each layer.

    Attributes:
        base_m: (n,) altitudes where layers begin, rising from 0; the last one has no end.
        share: (n,) factors of the exponentials.
        scale_height_m: (n,).
    """

    base_m: tuple[float, ...]
    share: tuple[float, ...]
    scale_height_m: tuple[float, ...]

    @classmethod
    def of(cls, scale_height_m: float, above: Sequence[tuple[float, float]] = ()) -> Self:
        """The density by its scale height on the ground and, `above` altitudes, by others."""
        base_m, heights_m = [0.0], [scale_height_m]
        exponent = [0.0]
        for altitude_m, height_m in above:
            exponent.append(exponent[-1] + altitude_m * (1.0 / height_m - 1.0 / heights_m[-1]))
            base_m.append(altitude_m)
            heights_m.append(height_m)
        return cls(tuple(base_m), tuple(map(math.exp, exponent)), tuple(heights_m))

    def density(self, altitude_m: ArrayLike) -> FloatArray:
        """Relative density (...,) at altitudes (...,)."""
        height = np.asarray(altitude_m, dtype=float)
        if len(self.base_m) == 1:
            return np.exp(-height / self.scale_height_m[0])
        base_m, share, scale_height_m = _arrays(self)
        layer = base_m[1:].searchsorted(height, side="right")
        return np.asarray(share[layer] * np.exp(-height / scale_height_m[layer]))

    def array(self) -> FloatArray:
        """Bases, shares, scale heights and densities at the bases (4, n), for compiled code."""
        return np.array([*self, self.density(self.base_m)])

    def column_m(self, top_m: float = math.inf, power: float = 1.0) -> float:
        """Integral of a power of the density over the altitude, from 0 to `top_m`."""
        ends_m = (*self.base_m[1:], math.inf)
        column_m = 0.0
        for base, end, share, height_m in zip(
            self.base_m, ends_m, self.share, self.scale_height_m, strict=True
        ):
            per_m = power / height_m
            if base < top_m:
                thinned = math.exp(-base * per_m) - math.exp(-min(end, top_m) * per_m)
                column_m += share**power * thinned / per_m
        return column_m

    def raised(self, altitude_m: float) -> tuple[Self, float]:
        """The density above another ground, over that at it; and that one over the old ground's."""
        layer = max(sum(base <= altitude_m for base in self.base_m), 1) - 1
        above = [
            (base - altitude_m, height_m)
            for base, height_m in zip(self.base_m, self.scale_height_m, strict=True)
        ][layer + 1 :]
        return self.of(self.scale_height_m[layer], above), float(self.density(altitude_m))


@lru_cache(maxsize=64)
def _arrays(layers: ExponentialLayers) -> tuple[FloatArray, FloatArray, FloatArray]:
    base_m, share, scale_height_m = (np.array(numbers) for numbers in layers)
    return base_m, share, scale_height_m

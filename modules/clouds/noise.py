"""The noise of clouds: a weather map, a volume of billows, and one of detail for their edges.

All are made from integer hashes of a seed, and are periodic without a seam.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray

WEATHER_SIZE, SHAPE_SIZE, DETAIL_SIZE = 512, 128, 64
# Cells of the coarsest octave in a period.
_FIELDS, _CELLS = 7, 19
_BILLOWS, _FRINGES = 5, 3
# Share of a volume's values that is clipped at either end.
_CUT = 0.005


class Noises(NamedTuple):
    """Weather (n, n) uint16, uniformly distributed; shape and detail (n, n, n) uint8, y first."""

    weather: NDArray[np.uint16]
    shape: NDArray[np.uint8]
    detail: NDArray[np.uint8]


@lru_cache(maxsize=2)
def noises(seed: int) -> Noises:
    """The noises of a seed; those of the last two seeds are cached."""
    return Noises(weather_map(seed), shape_volume(seed), detail_volume(seed))


def weather_map(seed: int, size: int = WEATHER_SIZE) -> NDArray[np.uint16]:
    """Convection cells, grouped in fields: values (size, size), uniformly distributed."""
    from clouds.noise_kernels import perlin, worley

    at = _places((1, size, size))
    fields = _octaves(perlin, at, _FIELDS, 5, seed)
    cells = worley(at, _CELLS, seed) + 0.4 * worley(at, 2 * _CELLS, seed + 1)
    mixed = 1.1 * fields + 0.75 * cells
    ranks = np.empty(mixed.size)
    ranks[np.argsort(mixed, kind="stable")] = np.arange(mixed.size)
    return np.round(ranks / (mixed.size - 1) * 65535.0).astype(np.uint16).reshape(size, size)


def shape_volume(seed: int, size: int = SHAPE_SIZE) -> NDArray[np.uint8]:
    """Billows (size, size, size): Worley's noise, modulated by Perlin's."""
    from clouds.noise_kernels import perlin, worley

    at = _places((size, size, size))
    billows = _octaves(worley, at, _BILLOWS, 4, seed + 101, gain=0.5)
    mixed = 0.62 * billows + 0.38 * (0.5 + 0.7 * _octaves(perlin, at, _BILLOWS - 1, 3, seed + 202))
    return _stretched(mixed).reshape(size, size, size)


def detail_volume(seed: int, size: int = DETAIL_SIZE) -> NDArray[np.uint8]:
    """Inverted small billows (size, size, size): largest farthest from their centres."""
    from clouds.noise_kernels import worley

    at = _places((size, size, size))
    return 255 - _stretched(_octaves(worley, at, _FRINGES, 4, seed + 303)).reshape((size,) * 3)


def _octaves(
    noise: Callable[[FloatArray, int, int], FloatArray],
    at: FloatArray,
    cells: int,
    octaves: int,
    seed: int,
    gain: float = 0.5,
) -> FloatArray:
    """The mean of octaves, each of twice the frequency and `gain` of the weight."""
    weights = gain ** np.arange(octaves)
    parts = [w * noise(at, cells * 2**k, seed + k) for k, w in enumerate(weights)]
    return np.asarray(sum(parts) / weights.sum())


def _places(shape: tuple[int, int, int]) -> FloatArray:
    """Centres (n, 3) of the cells of a box with edges of length 1."""
    axes = [(np.arange(size) + 0.5) / size for size in shape]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def _stretched(values: FloatArray) -> NDArray[np.uint8]:
    low, high = np.quantile(values, [_CUT, 1.0 - _CUT])
    return np.round(255.0 * np.clip((values - low) / (high - low), 0.0, 1.0)).astype(np.uint8)

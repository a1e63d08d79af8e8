"""The noise of clouds: a weather map, a volume of billows, and one of detail for their edges.

All are made from integer hashes of a seed, and are periodic without a seam.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from clouds.genera import Pattern
from clouds.noise_kernels import perlin, worley
from vrut_lite.numeric_types import FloatArray

WEATHER_SIZE, SHAPE_SIZE, DETAIL_SIZE = 512, 128, 64
# Cells of the coarsest octave in a period.
_FIELDS, _CELLS = 7, 19
_BILLOWS, _FRINGES = 5, 3
# Fibres of the coarsest octave along a period, how many times as many across, and how far fields
# bend them, in periods.
_ALONG, _ACROSS, _BEND = 3, 9, 0.12
# Share of a volume's values that is clipped at either end.
_CUT = 0.005


@lru_cache(maxsize=8)
def weather_map(
    seed: int, pattern: Pattern = "cells", size: int = WEATHER_SIZE
) -> NDArray[np.uint16]:
    """Where clouds stand: values (size, size), uniformly distributed.

    Cells of convection are grouped in fields; a sheet has fields alone; fibres run along the first
    axis of the world, in tufts.
    """
    at = _places((1, size, size))
    fields = _octaves(perlin, at, _FIELDS, 5, seed)
    if pattern == "cells":
        cells = worley(at, _CELLS, seed) + 0.4 * worley(at, 2 * _CELLS, seed + 1)
        fields = 0.7 * fields + 0.85 * cells
    elif pattern == "fibres":
        fields = 0.8 * fields + 0.9 * _fibres(at, fields, seed)
    ranks = np.empty(fields.size)
    ranks[np.argsort(fields, kind="stable")] = np.arange(fields.size)
    return np.round(ranks / (fields.size - 1) * 65535.0).astype(np.uint16).reshape(size, size)


def _fibres(at: FloatArray, fields: FloatArray, seed: int) -> FloatArray:
    """Noise (n,) drawn out along x, and bent by the fields (n,)."""
    # A slanted cut through a volume: so many times as many cells across as along, and yet periodic.
    bent = at[:, 1] + _BEND * fields
    cut = np.stack([bent, bent * _ACROSS, at[:, 2]], axis=-1)
    return _octaves(perlin, cut, _ALONG, 4, seed + 50)


@lru_cache(maxsize=2)
def shape_volume(seed: int, size: int = SHAPE_SIZE) -> NDArray[np.uint8]:
    """Billows (size, size, size): Worley's noise, modulated by Perlin's."""
    at = _places((size, size, size))
    billows = _octaves(worley, at, _BILLOWS, 4, seed + 101, gain=0.5)
    mixed = 0.62 * billows + 0.38 * (0.5 + 0.7 * _octaves(perlin, at, _BILLOWS - 1, 3, seed + 202))
    return _stretched(mixed).reshape(size, size, size)


@lru_cache(maxsize=2)
def detail_volume(seed: int, size: int = DETAIL_SIZE) -> NDArray[np.uint8]:
    """Inverted small billows (size, size, size): largest farthest from their centres."""
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

"""A `CloudLayer` as the kernels take it: the noises with their means, and the eye's place in them.

Importing this module imports numba.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from clouds.model.cloud_density import (
    noise_origin,
    warp_origin,
    weather_origin,
)
from clouds.model.cloud_density_kernels import Field, form_numbers
from clouds.model.cloud_spread import halved, spread_of
from vrut_lite.array import Array
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.numeric_types import Vector


def cloud_field(layer: CloudLayer, eye_m: Vector) -> Field:
    """The layer prepared for an eye."""
    level_m, form = np.array([eye_m[0], eye_m[2]]), layer.form
    origin = (of(layer, level_m) for of in (weather_origin, noise_origin, warp_origin))
    texels, levels, counts = _mips(layer.weather, layer.shape, layer.detail)
    periods_m = (*form.weather_periods_m, form.shape_period_m, form.detail_period_m)
    edges = levels[[0, 0, 1, 2], 0, 1]
    return Field(
        texels=texels,
        levels=levels,
        logs=tuple(float(log) for log in np.log2(edges / periods_m)),
        last=tuple(float(count - 1) for count in counts),
        spread=spread_of(layer),
        origin=tuple(float(part) for part in np.concatenate([*origin])),
        threshold=float(layer.threshold),
        extinction_per_m=float(layer.extinction_per_m),
        base_m=float(layer.base_m),
        thickness_m=float(layer.thickness_m),
        eye_altitude_m=float(eye_m[1]),
        form=form_numbers(form),
    )


def noise_array(layer: CloudLayer) -> Array:
    """The `texels` of a layer's field, the same object for the same noises."""
    return _noise_array(layer.weather, layer.shape, layer.detail)


@lru_cache(maxsize=4)
def _noise_array(*noises: Array) -> Array:
    # A copy: an `Array` may not be written to, and kernels are compiled for those that may.
    return Array(_mips(*noises)[0].copy())


@lru_cache(maxsize=4)
def _mips(*noises: Array) -> tuple[NDArray[np.float32], NDArray[np.int64], list[int]]:
    """All noises and their levels as `Field` has them, and how many levels each has."""
    kinds = [halved(noise.values) for noise in noises]
    counts = [len(levels) for levels in kinds]
    places = np.zeros((len(kinds), max(counts), 2), np.int64)
    start = 0
    for kind, levels in enumerate(kinds):
        for number, level in enumerate(levels):
            places[kind, number] = start, len(level)
            start += level.size
    flat = np.concatenate([level.ravel() for levels in kinds for level in levels])
    return flat, places, counts

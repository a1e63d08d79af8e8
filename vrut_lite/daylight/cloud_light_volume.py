"""Optical depths of a `CloudLayer` on a grid around an eye, compiled: towards the sun, away from
it, up and down. What lights a place in a cloud is looked up there, not marched.

Columns stand denser near the eye: x = near u / (1 - growth |u|), u in [-1, 1] along each axis;
heights are even. cloud_volume.comp is the twin. Importing this module imports numba.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.cloud_density_kernels import (
    column_in,
    compiled,
    density_in,
    envelope_in,
    narrowed,
)
from vrut_lite.daylight.cloud_grid import FARTHEST_M, GROWTH, LEAST_SINE, NEAR_M, SUB_STEPS
from vrut_lite.numeric_types import FloatArray

_COLUMNS, _HEIGHTS = 128, 16


class LightVolume(NamedTuple):
    """Depths (heights + 1, columns z, columns x, 4) float32: to the sun, away from it, up, down.

    They are those at the edges between heights, so that they are 0 where the layer ends.
    """

    depths: NDArray[np.float32]


def light_volume(field, sun: FloatArray) -> LightVolume:  # type: ignore[no-untyped-def]
    """The depths of a layer for a sun; below `LEAST_SINE` it counts as there."""
    density = np.empty((_HEIGHTS, _COLUMNS, _COLUMNS), np.float32)
    _fill(field, density)
    depths = np.zeros((_HEIGHTS + 1, _COLUMNS, _COLUMNS, 4), np.float32)
    step_m = field.thickness_m / _HEIGHTS
    sine = max(float(sun[1]), LEAST_SINE)
    slope = np.array([sun[0], sun[2]]) / sine * step_m
    _sum_along(density, depths, 0, slope, field.extinction_per_m * step_m / sine)
    _sum_along(density, depths, 2, np.zeros(2), field.extinction_per_m * step_m)
    return LightVolume(depths)


@compiled
def place_of(u):  # type: ignore[no-untyped-def]
    """Distance from the eye along an axis, m, of a coordinate in [-1, 1]."""
    return NEAR_M * u / (1.0 - GROWTH * abs(u))


@compiled
def _texel_of(x_m, size):  # type: ignore[no-untyped-def]
    """Columns, of which the first has its middle at 0."""
    x = min(max(x_m, -FARTHEST_M), FARTHEST_M)
    u = x / (NEAR_M + GROWTH * abs(x))
    return min(max((0.5 * u + 0.5) * size - 0.5, 0.0), size - 1.0)


@compiled
def _fill(field, density):  # type: ignore[no-untyped-def]
    heights, columns = density.shape[0], density.shape[1]
    for j in range(columns):
        z = place_of((2.0 * j + 1.0) / columns - 1.0)
        for i in range(columns):
            x = place_of((2.0 * i + 1.0) / columns - 1.0)
            far = max(abs(x), abs(z))
            stretch = (1.0 + GROWTH * far / NEAR_M) ** 2
            log_width = narrowed(2.0 * NEAR_M / columns * stretch)
            side, top = column_in(field, x, z, log_width)
            for k in range(heights):
                height = (k + 0.5) / heights
                envelope = envelope_in(field, side, top, height)
                density[k, j, i] = density_in(
                    field, envelope, x, z, height * field.thickness_m, log_width
                )


@compiled
def _flat(level, row, column):  # type: ignore[no-untyped-def]
    size = level.shape[0]
    j, i = min(int(row), size - 2), min(int(column), size - 2)
    t, s = row - j, column - i
    near = level[j, i] * (1.0 - s) + level[j, i + 1] * s
    far = level[j + 1, i] * (1.0 - s) + level[j + 1, i + 1] * s
    return near * (1.0 - t) + far * t


@compiled
def _sum_along(density, depths, part, slope_m, depth_of_step):  # type: ignore[no-untyped-def]
    """Depths along a direction into `part`, against it into the next.

    `slope_m` (2,): how far the direction goes along x and z while it rises by a voxel.
    """
    heights, columns = density.shape[0], density.shape[1]
    length_m = math.hypot(slope_m[0], slope_m[1])
    for way in range(2):
        sign = 1.0 if way == 0 else -1.0
        for n in range(heights):
            k = heights - 1 - n if way == 0 else n
            here, before = (k, k + 1) if way == 0 else (k + 1, k)
            for j in range(columns):
                z = place_of((2.0 * j + 1.0) / columns - 1.0)
                for i in range(columns):
                    x = place_of((2.0 * i + 1.0) / columns - 1.0)
                    far = max(abs(x), abs(z))
                    texel_m = 2.0 * NEAR_M / columns * (1.0 + GROWTH * far / NEAR_M) ** 2
                    steps = min(max(math.ceil(length_m / texel_m), 1), SUB_STEPS)
                    total = 0.0
                    for m in range(steps):
                        share = sign * (m + 0.5) / steps
                        row = _texel_of(z + slope_m[1] * share, columns)
                        column = _texel_of(x + slope_m[0] * share, columns)
                        total += _flat(density[k], row, column)
                    row = _texel_of(z + sign * slope_m[1], columns)
                    column = _texel_of(x + sign * slope_m[0], columns)
                    beyond = _flat(depths[before, :, :, part + way], row, column)
                    depths[here, j, i, part + way] = beyond + total * depth_of_step / steps


@compiled
def depths_at(depths, height, x, z, out):  # type: ignore[no-untyped-def]
    """The four depths at a place, into `out` (4,); its height is a share of the thickness."""
    heights, columns = depths.shape[0] - 1, depths.shape[1]
    place = min(max(height, 0.0), 1.0) * heights
    k = min(int(place), heights - 1)
    r = place - k
    row, column = _texel_of(z, columns), _texel_of(x, columns)
    j, i = min(int(row), columns - 2), min(int(column), columns - 2)
    t, s = row - j, column - i
    for c in range(4):
        value = 0.0
        for dk in range(2):
            level = depths[k + dk]
            near = level[j, i, c] * (1.0 - s) + level[j, i + 1, c] * s
            far = level[j + 1, i, c] * (1.0 - s) + level[j + 1, i + 1, c] * s
            value += (r if dk else 1.0 - r) * (near * (1.0 - t) + far * t)
        out[c] = value

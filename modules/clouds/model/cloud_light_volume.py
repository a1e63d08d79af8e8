"""Light in a `CloudLayer` on a grid around an eye, compiled: optical depths towards the sun,
up and down, and sunlight that is scattered again and again (`cloud_diffusion`). What
lights a place in a cloud is looked up there, not marched.

Columns stand denser near the eye (`cloud_grid`); heights are even. Frame and CPU use the same
numbers. Importing this module imports numba.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from clouds.model.cloud_density_kernels import (
    column_in,
    compiled,
    density_in,
    envelope_in,
    narrowed,
)
from clouds.model.cloud_diffusion import diffuse_light
from clouds.model.cloud_grid import (
    FARTHEST_M,
    LEAST_SINE,
    SUB_STEPS,
    growth_of,
    place_of,
    volume_near_m,
)
from vrut_lite.numeric_types import FloatArray

_HEIGHTS, _COLUMNS = 16, 160
# Depth at which no sunlight is left, within the range of float32.
DARKEST = 80.0
LEAST = math.exp(-DARKEST)


class LightVolume(NamedTuple):
    """Arrays (heights + 1, columns z, columns x, n) float32, at the edges between heights.

    Attributes:
        depths: to the sun, up, down.
        diffuse: fluence of scattered light, and its flux along world x, up and z, of a sun of
            irradiance 1.
        near_m: of the grid, see `cloud_grid`.
    """

    depths: NDArray[np.float32]
    diffuse: NDArray[np.float32]
    near_m: float


def light_volume(field, sun: FloatArray, diffused: float) -> LightVolume:  # type: ignore[no-untyped-def]
    """The light in a layer; a sun below `LEAST_SINE` counts as there.

    `diffused`: share of the extinction that diffuses (`scatterer`).
    """
    columns = _COLUMNS
    near_m = volume_near_m(field.thickness_m)
    growth = growth_of(near_m)
    middles = (2.0 * np.arange(columns) + 1.0) / columns - 1.0
    places_m = np.array([place_of(u, near_m) for u in middles])
    widths_m = 2.0 * near_m / columns * (1.0 + growth * np.abs(places_m) / near_m) ** 2
    grid = places_m, widths_m, near_m
    density = np.empty((_HEIGHTS, columns, columns), np.float32)
    _fill(field, grid, density)
    depths = np.zeros((_HEIGHTS + 1, columns, columns, 3), np.float32)
    step_m = field.thickness_m / _HEIGHTS
    sine = max(float(sun[1]), LEAST_SINE)
    slope = np.array([sun[0], sun[2]]) / sine * step_m
    per_m = float(field.extinction_per_m)
    scattered = np.zeros_like(density)
    _sum_to_sun(grid, density, depths, scattered, slope, per_m * step_m / sine, diffused)
    depths[-2::-1, ..., 1] = np.cumsum(density[::-1], axis=0) * (per_m * step_m)
    depths[1:, ..., 2] = np.cumsum(density, axis=0) * (per_m * step_m)
    towards = np.array([sun[0], sine, sun[2]])
    diffuse = diffuse_light(
        density, depths, scattered, towards, step_m, near_m, diffused * per_m, diffused
    )
    _even_outside(depths, diffuse, diffused)
    return LightVolume(depths, diffuse, near_m)


def _even_outside(
    depths: NDArray[np.float32], diffuse: NDArray[np.float32], diffused: float
) -> None:
    """Give the outermost columns their mean: beyond the grid they would show as streaks."""
    ring = np.ones(depths.shape[1:3], bool)
    ring[1:-1, 1:-1] = False
    # The mean of transmitted sunlight, not of the depth.
    lit = np.exp(-diffused * depths[:, ring, 0]).mean(axis=1, dtype=float)
    depths[:, ring] = depths[:, ring].mean(axis=1, keepdims=True)
    depths[:, ring, 0] = (-np.log(np.maximum(lit, np.exp(-DARKEST))) / diffused)[:, None]
    diffuse[:, ring] = diffuse[:, ring].mean(axis=1, keepdims=True)


@compiled
def _texel_of(x_m, size, near_m):  # type: ignore[no-untyped-def]
    """Columns, of which the first has its middle at 0."""
    x = min(max(x_m, -FARTHEST_M), FARTHEST_M)
    u = x / (near_m + (1.0 - near_m / FARTHEST_M) * abs(x))
    return min(max((0.5 * u + 0.5) * size - 0.5, 0.0), size - 1.0)


@compiled
def _fill(field, grid, density):  # type: ignore[no-untyped-def]
    places_m, widths_m, _ = grid
    heights = density.shape[0]
    for j in range(places_m.size):
        for i in range(places_m.size):
            x, z = places_m[i], places_m[j]
            log_width = narrowed(max(widths_m[i], widths_m[j]))
            above, spread = column_in(field, x, z, log_width)
            for k in range(heights):
                # At Gauss's two places of a cell, which base and top may cut.
                total = 0.0
                for m in range(2):
                    height = (k + (0.2113249, 0.7886751)[m]) / heights
                    envelope = envelope_in(field, above, spread, height)
                    total += 0.5 * density_in(
                        field, envelope, x, z, height * field.thickness_m, log_width
                    )
                density[k, j, i] = total


@compiled
def _flat(level, row, column):  # type: ignore[no-untyped-def]
    size = level.shape[0]
    j, i = min(int(row), size - 2), min(int(column), size - 2)
    t, s = row - j, column - i
    near = level[j, i] * (1.0 - s) + level[j, i + 1] * s
    far = level[j + 1, i] * (1.0 - s) + level[j + 1, i + 1] * s
    return near * (1.0 - t) + far * t


@compiled
def _sum_to_sun(grid, density, depths, scattered, slope_m, depth_of_step, diffused):  # type: ignore[no-untyped-def]
    """Depths towards the sun, from the top down, and the share of its light that cells scatter.

    `slope_m` (2,): how far the way goes along x and z while it rises by a cell. Between columns
    light is interpolated, not depth: a bright gap beside a cloud keeps its light. What a way loses
    goes to the columns beside it, as dense as each is: no light is lost.
    """
    places_m, widths_m, near_m = grid
    heights, size = density.shape[0], places_m.size
    length_m = math.hypot(slope_m[0], slope_m[1])
    passed = np.ones((size, size), np.float32)
    left = np.empty((size, size), np.float32)
    for k in range(heights - 1, -1, -1):
        for j in range(size):
            for i in range(size):
                x, z = places_m[i], places_m[j]
                texel_m = max(widths_m[i], widths_m[j])
                steps = min(max(math.ceil(length_m / texel_m), 1), SUB_STEPS)
                row = _texel_of(z + slope_m[1], size, near_m)
                column = _texel_of(x + slope_m[0], size, near_m)
                light = _flat(passed, row, column)
                depth = -math.log(light)
                area_m2 = widths_m[i] * widths_m[j]
                for m in range(steps - 1, -1, -1):
                    share = (m + 0.5) / steps
                    row = _texel_of(z + slope_m[1] * share, size, near_m)
                    column = _texel_of(x + slope_m[0] * share, size, near_m)
                    mean = _flat(density[k], row, column)
                    if mean <= 0.0:
                        continue
                    step = diffused * mean * depth_of_step / steps
                    depth += step
                    lost = light
                    light *= math.exp(-step)
                    lost = (lost - light) * area_m2 / mean
                    b, a = min(int(row), size - 2), min(int(column), size - 2)
                    t, s = row - b, column - a
                    for n in range(2):
                        for c in range(2):
                            weight = (t if n else 1.0 - t) * (s if c else 1.0 - s)
                            scattered[k, b + n, a + c] += (
                                lost * weight * density[k, b + n, a + c]
                            ) / (widths_m[b + n] * widths_m[a + c])
                depths[k, j, i, 0] = depth / diffused
                left[j, i] = max(light, LEAST)
        passed[:] = left


@compiled
def volume_at(volume, near_m, height, x, z, out):  # type: ignore[no-untyped-def]
    """A volume's numbers at a place, into `out`; its height is a share of the whole."""
    heights, columns = volume.shape[0] - 1, volume.shape[1]
    place = min(max(height, 0.0), 1.0) * heights
    k = min(int(place), heights - 1)
    r = place - k
    row, column = _texel_of(z, columns, near_m), _texel_of(x, columns, near_m)
    j, i = min(int(row), columns - 2), min(int(column), columns - 2)
    t, s = row - j, column - i
    for c in range(volume.shape[3]):
        value = 0.0
        for dk in range(2):
            level = volume[k + dk]
            near = level[j, i, c] * (1.0 - s) + level[j, i + 1, c] * s
            far = level[j + 1, i, c] * (1.0 - s) + level[j + 1, i + 1, c] * s
            value += (r if dk else 1.0 - r) * (near * (1.0 - t) + far * t)
        out[c] = value

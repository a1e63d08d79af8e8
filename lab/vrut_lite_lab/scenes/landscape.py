"""The heights of a land of mountains, 41 km wide: rivers carve it, gravel fills its valleys.

Axes are the world's: x east, z south, metres. Heights count from the planet's round surface.
"""

from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.scenes.erosion import drainage, drained_cells, erode, river_levels
from vrut_lite_lab.scenes.noise import fractal_noise, gradient_noise, ridged_noise

# The view is from the origin to the west: most of the land lies there.
WIDTH_M = 40960.0
WEST_M, NORTH_M = -34560.0, -20480.0
HIGHEST_M = 2480.0
KNOLL_M = 520.0
# Where the land rises more than elsewhere: x, z, by how much. The first closes the valley.
GREAT_MOUNTAINS = (
    (-29800.0, -1700.0, 4.2), (-14500.0, -4600.0, 2.4), (-9500.0, 5200.0, 2.0),
    (-19500.0, 4200.0, 1.8), (-4600.0, -3600.0, 1.4),
)  # fmt: skip
# A lake in the valley's floor: level, middle and half axes.
LAKE_M, LAKE_X_M, LAKE_Z_M, LAKE_LONG_M, LAKE_WIDE_M = 84.0, -4700.0, 640.0, 1900.0, 620.0
_CELLS = 1024
_RIM_M = 3600.0
# The main valley, from its head to where it leaves the land: x and z.
VALLEY_M = np.array([
    (-24500, -1300), (-20500, -300), (-15000, -900), (-10000, -100), (-5000, 700),
    (-800, 1050), (2500, 2100), (6400, 4200),
], dtype=float)  # fmt: skip


@dataclass(frozen=True)
class Landscape:
    """Heights (n, n) at nodes, rows from north to south, and what water says of them.

    `river_m` is the level of the river into which a node drains; `drained_m2` the area that
    drains through it.
    """

    height_m: FloatArray
    river_m: FloatArray
    drained_m2: FloatArray


def nodes_m(cells: int) -> tuple[FloatArray, FloatArray]:
    """World x and z of a grid's nodes, each (cells + 1, cells + 1)."""
    at = np.arange(cells + 1) * (WIDTH_M / cells)
    x, z = np.meshgrid(WEST_M + at, NORTH_M + at)
    return x, z


@cache
def landscape() -> Landscape:
    """The land on nodes 40 m apart."""
    height_m = np.zeros((_CELLS // 8 + 1,) * 2)
    for cells, steps in ((_CELLS // 8, 150), (_CELLS // 4, 60), (_CELLS // 2, 16), (_CELLS, 4)):
        height_m = _carved(_refined(height_m, cells), cells, steps)
    height_m = height_m * (HIGHEST_M / height_m.max())
    return _with_flat_floors(height_m)


def sample(grid: FloatArray, x_m: ArrayLike, z_m: ArrayLike) -> FloatArray:
    """A grid's smooth surface (...,): a quadratic B-spline, of which the slope has no steps."""
    spacing_m = WIDTH_M / (len(grid) - 1)
    column, row = (
        (np.asarray(at, float) - low) / spacing_m for at, low in ((x_m, WEST_M), (z_m, NORTH_M))
    )
    nearest = [np.clip(np.floor(at + 0.5), 1, len(grid) - 2) for at in (row, column)]
    weights = []
    for at, middle in zip((row, column), nearest, strict=True):
        t = at - middle
        weights.append((0.5 * (0.5 - t) ** 2, 0.75 - t * t, 0.5 * (0.5 + t) ** 2))
    i, j = (middle.astype(np.int64) for middle in nearest)
    total = np.zeros(np.broadcast(row, column).shape)
    for di in range(3):
        for dj in range(3):
            total += weights[0][di] * weights[1][dj] * grid[i + di - 1, j + dj - 1]
    return total


def valley_distance_m(x_m: ArrayLike, z_m: ArrayLike) -> FloatArray:
    """How far (...,) a place is from the middle of the main valley."""
    x, z = np.asarray(x_m, dtype=float), np.asarray(z_m, dtype=float)
    nearest = np.full(np.broadcast(x, z).shape, np.inf)
    for (x0, z0), (x1, z1) in pairwise(VALLEY_M):
        dx, dz = x1 - x0, z1 - z0
        t = np.clip(((x - x0) * dx + (z - z0) * dz) / (dx * dx + dz * dz), 0.0, 1.0)
        nearest = np.minimum(nearest, (x - x0 - t * dx) ** 2 + (z - z0 - t * dz) ** 2)
    return np.sqrt(nearest)


def rim_share(x_m: ArrayLike, z_m: ArrayLike, width_m: float = _RIM_M) -> FloatArray:
    """0 (...,) at the land's rim, 1 further in than a width, without a corner between."""
    x, z = np.asarray(x_m, dtype=float), np.asarray(z_m, dtype=float)
    to_rim = [x - WEST_M, WEST_M + WIDTH_M - x, z - NORTH_M, NORTH_M + WIDTH_M - z]
    return np.asarray(np.prod([smooth_step(side / width_m) for side in to_rim], axis=0))


def smooth_step(t: ArrayLike) -> FloatArray:
    """0 below 0, 1 above 1, a cubic between."""
    inside = np.clip(t, 0.0, 1.0)
    return np.asarray(inside * inside * (3.0 - 2.0 * inside))


def _carved(height_m: FloatArray, cells: int, steps: int) -> FloatArray:
    x, z = nodes_m(cells)
    uplift = _uplift(x, z)
    hard = 0.7 + 0.2 * gradient_noise(x / 2300.0, z / 2300.0, 41)
    hard += 0.14 * gradient_noise(x / 620.0, z / 620.0, 43)
    return erode(height_m, 20.0 * uplift, np.clip(hard, 0.42, 1.05), WIDTH_M / cells, 0.06, steps)


def _uplift(x: FloatArray, z: FloatArray) -> FloatArray:
    """How fast the land rises (..., 0 to about 1.5): ranges and basins, little along the valley."""
    bend = [1900.0 * fractal_noise(x / 9000.0, z / 9000.0, seed, 3) for seed in (5, 6)]
    ranges = ridged_noise((x + bend[0]) / 15000.0 + 0.3, (z + bend[1]) / 11000.0, 3, 3)
    valley = (valley_distance_m(x + 0.2 * bend[1], z + 0.2 * bend[0]) / 1080.0) ** 2
    great = sum(
        height / (1.0 + ((x - east) / 2100.0) ** 2 + ((z - south) / 2400.0) ** 2)
        for east, south, height in GREAT_MOUNTAINS
    )
    rise = (0.5 + 0.62 * ranges + great) * (0.06 + valley) / (1.0 + valley)
    rim = rim_share(x + 0.5 * bend[0], z + 0.5 * bend[1]) * rim_share(x, z)
    return np.asarray(rise * rim * (1.0 + 0.5 * gradient_noise(x / 430.0, z / 430.0, 9)))


def _refined(height_m: FloatArray, cells: int) -> FloatArray:
    """The same land on more nodes."""
    if len(height_m) == cells + 1:
        return height_m
    x, z = nodes_m(cells)
    # Water runs straight along a grid's rows; the next finer one sees that bent.
    length_m = 8.0 * WIDTH_M / len(height_m)
    bend = [
        0.16 * length_m * fractal_noise(x / length_m, z / length_m, seed, 2) for seed in (71, 73)
    ]
    finer = sample(height_m, x + bend[0], z + bend[1])
    finer[[0, -1], :] = 0.0
    finer[:, [0, -1]] = 0.0
    return finer


def _with_flat_floors(height_m: FloatArray) -> Landscape:
    """Gravel lies in the valleys, the higher the wider the river; cirques are rounded."""
    order, below, filled = drainage(height_m)
    area_m2 = drained_cells(order, below) * (WIDTH_M / _CELLS) ** 2
    river_m = _smoothed(river_levels(filled, order, below, area_m2 > 4e6), 2)
    x, z = nodes_m(_CELLS)
    rim = rim_share(x, z)
    near = 1.0 / (1.0 + (valley_distance_m(x, z) / 1300.0) ** 2)
    floor_m = river_m + (34.0 + 40.0 * near) * rim
    rounded_m = 0.7 * _smoothed(filled, 3) + 0.3 * filled
    land = _smooth_maximum(rounded_m, floor_m, 80.0)
    land[[0, -1], :] = 0.0
    land[:, [0, -1]] = 0.0
    land = _smooth_maximum(land, KNOLL_M - (x * x + z * z) / 900.0, 60.0)
    bed_m = LAKE_M + 45.0 * (lake_reach(x, z) - 1.0)
    land = np.where(land < LAKE_M + 70.0, _smooth_minimum(land, bed_m), land)
    return Landscape(land, river_m, area_m2.reshape(land.shape))


def lake_reach(x_m: ArrayLike, z_m: ArrayLike) -> FloatArray:
    """0 (...,) at the lake's middle, 1 where its shore is or a slope stands in its way."""
    x, z = np.asarray(x_m, dtype=float), np.asarray(z_m, dtype=float)
    wave = 0.3 * gradient_noise(x / 700.0, z / 700.0, 77)
    # The shore runs with the valley: two to the south in fifteen to the east.
    aside = z - LAKE_Z_M - 0.13 * (x - LAKE_X_M)
    return np.asarray(((x - LAKE_X_M) / LAKE_LONG_M) ** 2 + (aside / LAKE_WIDE_M) ** 2 + wave)


def _smooth_minimum(a: FloatArray, b: FloatArray) -> FloatArray:
    return -_smooth_maximum(-a, -b, 8.0)


def _smooth_maximum(a: FloatArray, b: FloatArray, width: float) -> FloatArray:
    share = np.maximum(width - np.abs(a - b), 0.0) / width
    return np.asarray(np.maximum(a, b) + width * share * share * share / 6.0)


def _smoothed(grid: FloatArray, times: int) -> FloatArray:
    """Binomial weights over three by three nodes, so many times."""
    for _ in range(times):
        wide = np.pad(grid, 1, mode="edge")
        tall = 0.25 * wide[:-2] + 0.5 * wide[1:-1] + 0.25 * wide[2:]
        grid = 0.25 * tall[:, :-2] + 0.5 * tall[:, 1:-1] + 0.25 * tall[:, 2:]
    return grid

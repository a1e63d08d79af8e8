"""Zenith cosines mu of the rows of an `AirVolume`.

Rows above the horizon: mu = mu_h + (1 - mu_h) x^2 (2 - x^2), x uniform in [0, 1]: dense toward the
horizon, where radiance changes fast, and uniform in the angle about the zenith, across which light
has a slope. For an eye above the air mu = mu_h + (mu_top - mu_h) x^2, with mu_top the edge of the
air.

Rows below the horizon: mu = mu_h - (1 + mu_h) d with d = c x^2 / (1 - (1 - c) x^2). c is 1 for an
eye on the ground or far in space. It is small for an eye high in the air, which makes rows denser
toward the horizon: there, a hundred kilometres away, a degree is two kilometres of height. One row
is moved to the ray that ends both at the reach and at the depth (`BELOW_LEVEL_M`), or that grazes
the depth, because values have a kink there.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.air import AirVolume
from vrut_lite.numeric_types import FloatArray

# Rays continue this far below the ground's level, for objects that stand there.
BELOW_LEVEL_M = 500.0
# c falls from 1 by _MOST_CROWDED at most: by half of that at _CROWDING_ALTITUDE_M, and again by
# half of it at the top of the air, above which c returns to 1.
_MOST_CROWDED, _CROWDING_ALTITUDE_M = 0.95, 1000.0


class AirGrid(NamedTuple):
    """The parameters that place the nodes, named as in `AirVolume`."""

    observer_altitude_m: float
    ground_radius_m: float
    top_altitude_m: float
    reach_m: float
    rows_above: int
    rows_below: int


class RowsBelow(NamedTuple):
    """Spacing of rows below the horizon: c, and the x and the place of the moved row.

    A place is row / (rows - 1); x is linear in it on either side of the moved row.
    """

    crowding: float
    moved_x: float
    moved_place: float


def grid_of(volume: AirVolume) -> AirGrid:
    """The grid of a volume."""
    return AirGrid(*(getattr(volume, name) for name in AirGrid._fields))


def horizon_depth(grid: AirVolume | AirGrid) -> FloatArray:
    """1 + mu (2,) of the ground's horizon, and of the zenith or, from above the air, its edge."""
    edge = 2.0 if _inside(grid) else _grazing_depth(grid, grid.top_altitude_m)
    return np.array([_grazing_depth(grid, 0.0), edge])


def row_heights(grid: AirGrid) -> FloatArray:
    """1 + mu (rows,), first the rows above the horizon, both parts outward from the horizon."""
    horizon, top = horizon_depth(grid)
    up = np.linspace(0.0, 1.0, grid.rows_above) ** 2
    if _inside(grid):
        up = up * (2.0 - up)
    below, place = rows_below(grid), np.linspace(0.0, 1.0, grid.rows_below)
    x = np.interp(place, [0.0, below.moved_place, 1.0], [0.0, below.moved_x, 1.0])
    c = below.crowding
    down = c * x * x / (1.0 - (1.0 - c) * x * x)
    # Exactly the nadir, without rounding.
    down[-1] = 1.0
    return np.concatenate([horizon + (top - horizon) * up, horizon * (1.0 - down)])


def rows_of(grid: AirGrid, one_plus: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Fractional row (...,) of a height 1 + mu, and whether it is below the horizon."""
    horizon, top = horizon_depth(grid)
    is_below = one_plus < horizon
    squared = np.clip((one_plus - horizon) / (top - horizon), 0.0, 1.0)
    if _inside(grid):
        squared = squared / (1.0 + np.sqrt(1.0 - squared))
    up = np.sqrt(squared)
    below, down = rows_below(grid), np.clip((horizon - one_plus) / horizon, 0.0, 1.0)
    c = below.crowding
    x = np.sqrt(down / (c + (1.0 - c) * down))
    place = np.interp(x, [0.0, below.moved_x, 1.0], [0.0, below.moved_place, 1.0])
    lowest = grid.rows_above + place * (grid.rows_below - 1)
    return np.where(is_below, lowest, up * (grid.rows_above - 1)), is_below


def rows_below(grid: AirVolume | AirGrid) -> RowsBelow:
    """The spacing of the rows below the horizon."""
    altitude_m, in_space = grid.observer_altitude_m, grid.observer_altitude_m / grid.top_altitude_m
    rise = altitude_m / (altitude_m + _CROWDING_ALTITUDE_M)
    c = 1.0 - _MOST_CROWDED * rise / (1.0 + in_space * in_space)
    horizon, last = horizon_depth(grid)[0], grid.rows_below - 1
    down = max((horizon - _bend_depth(grid)) / horizon, 0.0)
    x = float(np.sqrt(down / (c + (1.0 - c) * down)))
    # Rounded up, which makes rows denser toward the horizon.
    row = min(math.ceil(x * last), last - 1)
    if not (0.0 < x < 1.0 and 0 < row < last):
        return RowsBelow(c, 0.5, 0.5)
    return RowsBelow(c, x, row / last)


def _inside(grid: AirVolume | AirGrid) -> bool:
    return grid.observer_altitude_m <= grid.top_altitude_m


def _bend_depth(grid: AirVolume | AirGrid) -> float:
    """1 + mu of the ray that meets the depth just at the reach, or that grazes the depth.

    It is 0, the nadir's, where the reach is shorter than the way straight down.
    """
    radius, eye_m = grid.ground_radius_m, grid.observer_altitude_m
    start = min(eye_m, grid.top_altitude_m)
    tangent_squared = (start + BELOW_LEVEL_M) * (2.0 * radius + start - BELOW_LEVEL_M)
    length = min(grid.reach_m, float(np.sqrt(tangent_squared)))
    down = (length + tangent_squared / length) / (2.0 * (radius + start))
    if down >= 1.0:
        return 0.0
    # For an eye above the air: convert from where the ray enters the air to the eye.
    sine = np.sqrt((1.0 - down) * (1.0 + down)) * (radius + start) / (radius + eye_m)
    return float(sine * sine / (1.0 + np.sqrt(max((1.0 - sine) * (1.0 + sine), 0.0))))


def _grazing_depth(grid: AirVolume | AirGrid, grazed_altitude_m: float) -> float:
    """1 + mu of the ray that descends from the observer to graze a lower altitude."""
    radius = grid.ground_radius_m + grid.observer_altitude_m
    grazed = grid.ground_radius_m + grazed_altitude_m
    sine = grazed / radius
    above = max(grid.observer_altitude_m - grazed_altitude_m, 0.0)
    cosine = np.sqrt(above * (radius + grazed)) / radius
    return float(sine * sine / (1.0 + cosine))

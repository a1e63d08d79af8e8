"""Which heights of view directions the rows of an `AirVolume` stand for.

Above the horizon they lie at mu = mu_h + (mu_top - mu_h) x^2, x uniform in [0, 1]: dense toward
the horizon, where radiance changes fast; mu_top is the zenith, or the edge of the air for an eye
above it.

Below it they lie at mu = mu_h - (1 + mu_h) d with d = c x^2 / (1 - (1 - c) x^2). For an eye on the
ground, or far in space, c is 1; for one high up in the air it is small, and rows are denser yet
toward the horizon: a hundred kilometres off, where the haze begins, a step of a degree is one of
two kilometres in height. One of the rows is moved to where rays begin to end in the depth and no
longer at the reach, or no longer pass over the depth: what is linear on either side has a bend
there.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.air import AirVolume
from vrut_lite.numeric_types import FloatArray

# How deep things may stand below the level: past that, air counts no more.
BELOW_LEVEL_M = 500.0
# How far below 1 c may come, and at which altitude it is half way there; the air's top, where it
# is half way back.
_MOST_CROWDED, _CROWDING_ALTITUDE_M = 0.95, 1000.0


class Grid(NamedTuple):
    """What the places of nodes depend on; its names are those of `AirVolume`."""

    observer_altitude_m: float
    ground_radius_m: float
    top_altitude_m: float
    reach_m: float
    rows_above: int
    rows_below: int


class RowsBelow(NamedTuple):
    """How rows lie below the horizon: c, and the x of the row that is moved and its own place.

    Places are shares of the rows' number; x runs evenly with them on either side of that row.
    """

    crowding: float
    moved_x: float
    moved_place: float


def grid_of(volume: AirVolume) -> Grid:
    """The grid of a volume."""
    return Grid(*(getattr(volume, name) for name in Grid._fields))


def horizon_depth(grid: AirVolume | Grid) -> FloatArray:
    """1 + mu (2,) of the ground's horizon, and of the zenith or, from above, the air's edge."""
    inside = grid.observer_altitude_m <= grid.top_altitude_m
    edge = 2.0 if inside else _grazing_depth(grid, grid.top_altitude_m)
    return np.array([_grazing_depth(grid, 0.0), edge])


def row_heights(grid: Grid) -> FloatArray:
    """1 + mu (rows,) of the rows, those above the horizon first, each from the horizon on."""
    horizon, top = horizon_depth(grid)
    up = np.linspace(0.0, 1.0, grid.rows_above) ** 2
    below, place = rows_below(grid), np.linspace(0.0, 1.0, grid.rows_below)
    x = np.interp(place, [0.0, below.moved_place, 1.0], [0.0, below.moved_x, 1.0])
    c = below.crowding
    down = c * x * x / (1.0 - (1.0 - c) * x * x)
    # The nadir is the nadir, to the last digit.
    down[-1] = 1.0
    return np.concatenate([horizon + (top - horizon) * up, horizon * (1.0 - down)])


def rows_of(grid: Grid, one_plus: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Which row (...,), as a fraction, a height 1 + mu lies on, and whether below the horizon."""
    horizon, top = horizon_depth(grid)
    is_below = one_plus < horizon
    up = np.sqrt(np.clip((one_plus - horizon) / (top - horizon), 0.0, 1.0))
    below, down = rows_below(grid), np.clip((horizon - one_plus) / horizon, 0.0, 1.0)
    c = below.crowding
    x = np.sqrt(down / (c + (1.0 - c) * down))
    place = np.interp(x, [0.0, below.moved_x, 1.0], [0.0, below.moved_place, 1.0])
    lowest = grid.rows_above + place * (grid.rows_below - 1)
    return np.where(is_below, lowest, up * (grid.rows_above - 1)), is_below


def rows_below(grid: AirVolume | Grid) -> RowsBelow:
    """How rows lie below the horizon."""
    altitude_m, in_space = grid.observer_altitude_m, grid.observer_altitude_m / grid.top_altitude_m
    rise = altitude_m / (altitude_m + _CROWDING_ALTITUDE_M)
    c = 1.0 - _MOST_CROWDED * rise / (1.0 + in_space * in_space)
    horizon, last = horizon_depth(grid)[0], grid.rows_below - 1
    down = max((horizon - _bend_depth(grid)) / horizon, 0.0)
    x = float(np.sqrt(down / (c + (1.0 - c) * down)))
    # Rather denser than sparser toward the horizon.
    row = min(math.ceil(x * last), last - 1)
    if not (0.0 < x < 1.0 and 0 < row < last):
        return RowsBelow(c, 0.5, 0.5)
    return RowsBelow(c, x, row / last)


def _bend_depth(grid: AirVolume | Grid) -> float:
    """1 + mu of the ray that meets the depth at the reach, or else only just.

    The nadir's, 0, where the reach is less than the way straight down.
    """
    radius, eye_m = grid.ground_radius_m, grid.observer_altitude_m
    start = min(eye_m, grid.top_altitude_m)
    tangent_squared = (start + BELOW_LEVEL_M) * (2.0 * radius + start - BELOW_LEVEL_M)
    length = min(grid.reach_m, float(np.sqrt(tangent_squared)))
    down = (length + tangent_squared / length) / (2.0 * (radius + start))
    if down >= 1.0:
        return 0.0
    # From above the air: the height, at the eye, of the ray that enters like that.
    sine = np.sqrt((1.0 - down) * (1.0 + down)) * (radius + start) / (radius + eye_m)
    return float(sine * sine / (1.0 + np.sqrt(max((1.0 - sine) * (1.0 + sine), 0.0))))


def _grazing_depth(grid: AirVolume | Grid, grazed_altitude_m: float) -> float:
    """1 + mu of the ray that descends from the observer to graze a lower altitude."""
    radius = grid.ground_radius_m + grid.observer_altitude_m
    grazed = grid.ground_radius_m + grazed_altitude_m
    sine = grazed / radius
    above = max(grid.observer_altitude_m - grazed_altitude_m, 0.0)
    cosine = np.sqrt(above * (radius + grazed)) / radius
    return float(sine * sine / (1.0 + cosine))

"""Land that rises and is carved by rivers: the stream power law, with slopes that slide.

Braun and Willett 2013, "A very efficient O(n), implicit and parallel method to solve the stream
power equation", with the drainage of Barnes et al. 2014, "Priority-flood". Only sums, products,
quotients and square roots are used: every machine makes the same land.
"""

import heapq

import numpy as np
from numba import njit
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray

_TILT_M = 1e-3


@njit(cache=True)
def drainage(height_m: FloatArray) -> tuple[NDArray[np.int64], NDArray[np.int64], FloatArray]:
    """Where water goes on a grid (R, C), whose border is the sea.

    Returns:
        Cells from the sea upwards, flat (R C,); the cell below each (itself on the border); the
        height (R, C) with its hollows filled.
    """
    rows, columns = height_m.shape
    filled = np.full((rows, columns), np.inf)
    order = np.empty(rows * columns, np.int64)
    below = np.empty(rows * columns, np.int64)
    waiting = [(0.0, np.int64(0))]
    waiting.pop()
    for i in range(rows):
        for j in range(columns):
            if i in (0, rows - 1) or j in (0, columns - 1):
                filled[i, j] = height_m[i, j]
                below[i * columns + j] = i * columns + j
                heapq.heappush(waiting, (filled[i, j], np.int64(i * columns + j)))
    count = 0
    while len(waiting) > 0:
        level, cell = heapq.heappop(waiting)
        order[count] = cell
        count += 1
        row, column = cell // columns, cell % columns
        for i in range(max(row - 1, 0), min(row + 2, rows)):
            for j in range(max(column - 1, 0), min(column + 2, columns)):
                if filled[i, j] == np.inf:
                    filled[i, j] = max(height_m[i, j], level + _TILT_M)
                    below[i * columns + j] = cell
                    heapq.heappush(waiting, (filled[i, j], np.int64(i * columns + j)))
    _steepest(filled, below)
    return order, below, filled


@njit(cache=True)
def _steepest(filled: FloatArray, below: NDArray[np.int64]) -> None:
    """Water goes down the steepest way of eight."""
    rows, columns = filled.shape
    for row in range(1, rows - 1):
        for column in range(1, columns - 1):
            best = 0.0
            for di in range(-1, 2):
                for dj in range(-1, 2):
                    drop = filled[row, column] - filled[row + di, column + dj]
                    if di != 0 and dj != 0:
                        drop *= 0.7071067811865476
                    if drop > best:
                        best = drop
                        below[row * columns + column] = (row + di) * columns + column + dj


@njit(cache=True)
def drained_cells(order: NDArray[np.int64], below: NDArray[np.int64]) -> FloatArray:
    """How many cells (R C,) drain through each, itself included."""
    cells = np.ones(order.size)
    for at in range(order.size - 1, -1, -1):
        cell = order[at]
        if below[cell] != cell:
            cells[below[cell]] += cells[cell]
    return cells


@njit(cache=True)
def erode(
    height_m: FloatArray,
    uplift_m: FloatArray,
    steepest: FloatArray,
    spacing_m: float,
    strength: float,
    steps: int,
) -> FloatArray:
    """The land (R, C) after steps in each of which it rises and rivers cut into it.

    Args:
        height_m: the land before; its border stays.
        uplift_m: how much each cell rises in a step.
        steepest: the slope (R, C), rise over run, above which it slides.
        spacing_m: between cells.
        strength: what a river cuts: slope times square root of area (m) times this, in a step.
        steps: how many.
    """
    rows, columns = height_m.shape
    land = height_m.copy().reshape(-1)
    rise, limit = uplift_m.reshape(-1), steepest.reshape(-1)
    for _ in range(steps):
        order, below, _filled = drainage((land + rise).reshape(rows, columns))
        cells = drained_cells(order, below)
        for cell in order:
            lower = below[cell]
            if lower == cell:
                continue
            straight = lower // columns == cell // columns or lower % columns == cell % columns
            run_m = spacing_m if straight else 1.4142135623730951 * spacing_m
            cut = strength * np.sqrt(cells[cell]) * spacing_m / run_m
            risen = (land[cell] + rise[cell] + cut * land[lower]) / (1.0 + cut)
            land[cell] = min(risen, land[lower] + limit[cell] * run_m)
    return land.reshape(rows, columns)


@njit(cache=True)
def river_levels(
    height_m: FloatArray,
    order: NDArray[np.int64],
    below: NDArray[np.int64],
    wide: NDArray[np.bool_],
) -> FloatArray:
    """The height (R, C) of the wide river into which each cell drains; the sea's without one."""
    flat = height_m.copy().reshape(-1)
    level = flat.copy()
    for cell in order:
        if below[cell] != cell and not wide[cell]:
            level[cell] = level[below[cell]]
    return level.reshape(height_m.shape)

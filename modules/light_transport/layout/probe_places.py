"""Places of probes: a regular grid around parts without texels.

A probe may stand inside a wall. Its rays tell: those that end on a back side do not count, and a
probe with few counting rays takes the light of its neighbours
(`without_buried`).
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.light_map import ProbeGrid
from vrut_lite.numeric_types import BoolArray, FloatArray, vector

_MOST_PROBES, _MOST_A_SIDE = 2048, 64
# A box that is thinner, in steps, is a sheet.
_FLAT = 1e-3


def probe_grid(lower_m: FloatArray, upper_m: FloatArray, least_step_m: float) -> ProbeGrid:
    """Probes from one corner (3,) of a box to the other, with about equal spacing on all axes.

    Args:
        lower_m, upper_m: world axes.
        least_step_m: closer probes would add nothing.
    """
    size = np.maximum(np.asarray(upper_m) - lower_m, 0.0)
    step = max(least_step_m, float(size.max()) / (_MOST_A_SIDE - 1), 1e-9)
    while np.prod(_counts(size, step).astype(float)) > _MOST_PROBES:
        step *= 1.05
    counts = _counts(size, step)
    # The outermost stand an eighth of a step within the box, and above what it stands on; a flat
    # box gets probes on both sides of it.
    flat = size < _FLAT * step
    steps = np.where(flat, step, size / (counts - 0.75))
    lower = np.where(flat, lower_m - 0.5 * steps, lower_m + 0.125 * steps)
    return ProbeGrid(lower_m=vector(lower), step_m=vector(steps), counts=_whole(counts))


def probe_places_m(grid: ProbeGrid) -> FloatArray:
    """World places (nz, ny, nx, 3) of a grid's probes."""
    nx, ny, nz = grid.counts
    z, y, x = np.indices((nz, ny, nx))
    return np.asarray(grid.lower_m + np.stack([x, y, z], axis=-1) * np.asarray(grid.step_m))


def without_buried(light: NDArray[np.float32], buried: BoolArray) -> NDArray[np.float32]:
    """The light (nz, ny, nx, ...) of probes; those `buried` (nz, ny, nx) have their neighbours'.

    The light spreads from free probes step by step, each time as the mean of the up to six
    neighbours that have some. Where all are buried nothing changes.
    """
    if not np.any(buried) or np.all(buried):
        return light
    light, known = light.copy(), ~buried
    more = (1,) * (light.ndim - 3)
    while not np.all(known):
        total, count = np.zeros_like(light), np.zeros(known.shape, np.float32)
        for axis in range(3):
            for away in (1, -1):
                here = [slice(None)] * 3
                there = [slice(None)] * 3
                here[axis] = slice(1, None) if away == 1 else slice(None, -1)
                there[axis] = slice(None, -1) if away == 1 else slice(1, None)
                beside = known[tuple(there)]
                total[tuple(here)] += light[tuple(there)] * beside.reshape(beside.shape + more)
                count[tuple(here)] += beside
        reached = ~known & (count > 0)
        light[reached] = total[reached] / count[reached].reshape((-1, *more))
        known |= reached
    return light


def _counts(size: FloatArray, step: float) -> NDArray[np.int64]:
    return np.maximum(np.ceil(size / step - 1e-9).astype(np.int64) + 1, 2)


def _whole(values: NDArray[np.int64]) -> tuple[int, int, int]:
    return (int(values[0]), int(values[1]), int(values[2]))

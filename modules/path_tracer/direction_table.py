"""Directions from which light comes, by place and side of a surface: what guides paths.

A grid of cubes, six sides of surfaces in each (the axis nearest to the normal), and for each of
these rows a histogram over the sphere in bins of one solid angle. A draw is a bin by its share of
the row's light, and an even direction in it.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

# Bins by azimuth and by height: 5.6 degrees wide at the horizon and 3.6 high.
AZIMUTHS, HEIGHTS = 64, 32
BINS = AZIMUTHS * HEIGHTS
SIDES = 6
# Steps of a binary search in a row.
_SEARCH_STEPS = BINS.bit_length() - 1


class Grid(NamedTuple):
    """Cubes of one size in the tracer's units: lower corner, edge and counts along the axes."""

    lower: tuple[float, float, float]
    edge: float
    counts: tuple[int, int, int]

    @property
    def rows(self) -> int:
        """Number of pairs of a cube and a side."""
        return int(np.prod(self.counts)) * SIDES


class DirectionTable:
    """Histograms on the device, for one variant of mitsuba; rows without light guide nothing."""

    def __init__(
        self, mi: Any, grid: Grid, rows: NDArray[np.int_], light: NDArray[np.float64], share: float
    ):
        """`light` (n, BINS) of rows (n,) of the grid; `share` of directions is drawn from here."""
        import drjit

        self._dr: Any = drjit
        self._mi, self._grid, self._share = mi, grid, share
        total = light.sum(axis=1)
        lit = total > 0.0
        self.lit_rows = int(np.count_nonzero(lit))
        numbers = np.zeros(grid.rows, np.uint32)
        numbers[rows[lit]] = np.arange(1, self.lit_rows + 1, dtype=np.uint32)
        # A row at least, since an empty array is a constant of the code.
        below = np.zeros((max(self.lit_rows, 1), BINS + 1), np.float32)
        below[: self.lit_rows, 1:] = np.cumsum(light[lit], axis=1) / total[lit, None]
        self._numbers = mi.UInt32(numbers)
        self._below = mi.Float(below.ravel())

    def row(self, place: Any, normal: Any, active: Any) -> Any:
        """1 + the number of the histogram at points with normals to the viewer; 0 for none."""
        index, inside = grid_row(self._mi, self._grid, place, normal)
        return self._dr.gather(self._mi.UInt32, self._numbers, index, active & inside)

    def share(self, row: Any) -> Any:
        """Part of directions to draw from here."""
        return self._dr.select(row > 0, self._share, 0.0)

    def draw(self, row: Any, sample1: Any, sample2: Any, active: Any) -> Any:
        """World directions."""
        dr, mi = self._dr, self._mi
        active = active & (row > 0)
        first = (row - 1) * (BINS + 1)
        low = mi.UInt32(0)
        for step in range(_SEARCH_STEPS):
            middle = low + (BINS >> (step + 1))
            low = dr.select(
                dr.gather(mi.Float, self._below, first + middle, active) <= sample1, middle, low
            )
        azimuth = ((low % AZIMUTHS) + sample2.x) * (2.0 * np.pi / AZIMUTHS) - np.pi
        height = ((low // AZIMUTHS) + sample2.y) * (2.0 / HEIGHTS) - 1.0
        level = dr.safe_sqrt(1.0 - height * height)
        sine, cosine = dr.sincos(azimuth)
        return mi.Vector3f(level * cosine, height, level * sine)

    def density(self, row: Any, direction: Any, active: Any) -> Any:
        """Probability per steradian of `draw`."""
        dr, mi = self._dr, self._mi
        active = active & (row > 0)
        at = (row - 1) * (BINS + 1) + direction_bin(mi, direction)
        below = dr.gather(mi.Float, self._below, at, active)
        above = dr.gather(mi.Float, self._below, at + 1, active)
        return (above - below) * (BINS / (4.0 * np.pi))


def grid_row(mi: Any, grid: Grid, place: Any, normal: Any) -> tuple[Any, Any]:
    """Row of the grid for points and normals, and whether the points lie in the grid."""
    import drjit

    dr: Any = drjit
    at = (place - mi.Point3f(*grid.lower)) / grid.edge
    nx, ny, nz = grid.counts
    inside = (dr.min(at) >= 0.0) & (at.x < nx) & (at.y < ny) & (at.z < nz)
    x, y, z = (mi.UInt32(dr.clip(value, 0.0, 65535.0)) for value in at)
    ax, ay, az = (dr.abs(value) for value in normal)
    side = dr.select(
        (ax >= ay) & (ax >= az),
        dr.select(normal.x > 0.0, mi.UInt32(0), 1),
        dr.select(
            ay >= az,
            dr.select(normal.y > 0.0, mi.UInt32(2), 3),
            dr.select(normal.z > 0.0, mi.UInt32(4), 5),
        ),
    )
    return ((x * ny + y) * nz + z) * SIDES + side, inside


def direction_bin(mi: Any, direction: Any) -> Any:
    """Bin of world directions."""
    import drjit

    dr: Any = drjit
    around = (dr.atan2(direction.z, direction.x) + np.pi) * (AZIMUTHS / (2.0 * np.pi))
    up = (direction.y + 1.0) * (0.5 * HEIGHTS)
    column = dr.minimum(mi.UInt32(dr.maximum(around, 0.0)), AZIMUTHS - 1)
    return dr.minimum(mi.UInt32(dr.maximum(up, 0.0)), HEIGHTS - 1) * AZIMUTHS + column

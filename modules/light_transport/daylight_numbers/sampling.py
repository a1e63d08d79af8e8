"""Stratified rays of sensors, finer where the edges of openings are.

A sensor's hemisphere, weighted by the cosine, is a square (Shirley and Chiu 1997), cut into cells
with one ray each. Cells whose neighbourhood sees both what stands in the scene and what is beyond
it are cut into 4 x 4, and these again: an opening is found by its cells and then followed along its
edge, so that small ones are as right as large ones.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, minimum_filter

from light_transport.daylight_numbers.glass import Glass
from light_transport.daylight_numbers.sensor_rays import OPEN_GROUND, SKY, ends_of
from light_transport.daylight_numbers.sky_cells import on_disc
from light_transport.ray_scene import RayScene
from light_transport.rays.tree import Tree
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray, IntArray

_PARTS = 4
# A slit is followed over so many cells at most.
_MOST_STEPS = 12
# Mean square of what one ray errs by in a cell that an edge cuts anywhere.
_EDGE_VARIANCE = 1.0 / 6.0
_INSIDE, _ABOVE, _BELOW = 0, 1, 2


class Ends(NamedTuple):
    """Where rays (R) end: their sensors (R,), the share (R,) of the sensor's hemisphere that each
    stands for, its direction (R, 3), target (R, 2) and colours (R, 2, 3), see `ends_of`."""

    sensor: IntArray
    area: FloatArray
    direction: FloatArray
    target: NDArray[np.int32]
    share: Float32Array


class Traced(NamedTuple):
    """A scene to trace in, with its glass."""

    scene: RayScene
    tree: Tree
    glass: Glass


class _Leaves(NamedTuple):
    """Sensors, rows and columns (3, R) of squares that are cut into so many cells an edge."""

    where: NDArray[np.int64]
    cells: int


def sampled_ends(
    traced: Traced,
    places: FloatArray,
    normals: FloatArray,
    cells: int,
    error: float,
    random: np.random.Generator,
) -> tuple[Ends, Ends]:
    """Ends of the rays of sensors at `places` (S, 3) in radii, with unit `normals` (S, 3): twice.

    Both halves have a ray in each cell. Where cells are cut is told by rays that count in neither:
    the very rays that found an edge, or missed it, would err to one side.

    Args:
        traced: the scene.
        places, normals: of the sensors.
        cells: along each edge of the square, before cells are cut.
        error: share of the seen sky by which edges of openings may err; what errs less is not cut.
        random: where in their cells rays go.
    """
    cast = _Caster(traced, places, normals, random)
    leaves = _leaves(cast, len(places), cells, error)

    def half() -> Ends:
        parts = [cast(leaf) for leaf in leaves]
        return Ends(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))

    return half(), half()


def _leaves(cast: "_Caster", count: int, cells: int, error: float) -> list[_Leaves]:
    """Cells of three sizes that together fill the squares of so many sensors."""
    whole = _Leaves(np.indices((count, cells, cells)).reshape(3, -1), cells)
    kinds = _kind(cast(whole).target).reshape(count, cells, cells)
    low, high, cut = kinds.copy(), kinds.copy(), np.zeros(kinds.shape, bool)
    fine = _refined(kinds)
    for _ in range(_MOST_STEPS):
        new = (_at_edges(low, high) | _at_rim(high)) & ~cut
        if not new.any():
            break
        cut |= new
        where = np.stack(np.nonzero(_refined(new)))
        fine[tuple(where)] = _kind(cast(_Leaves(where, _PARTS * cells)).target)
        blocks = fine.reshape(count, cells, _PARTS, cells, _PARTS)
        low, high = blocks.min(axis=(2, 4)), blocks.max(axis=(2, 4))
    parts = _refined(cut)
    again = _at_edges(fine, fine) & parts
    seen = np.maximum((fine != _INSIDE).sum(axis=(1, 2)), 1)
    errs = np.sqrt(_EDGE_VARIANCE * again.sum(axis=(1, 2))) / seen
    again &= (errs > error)[:, None, None]
    return [
        _Leaves(np.stack(np.nonzero(~cut)), cells),
        _Leaves(np.stack(np.nonzero(parts & ~again)), _PARTS * cells),
        _Leaves(np.stack(np.nonzero(_refined(again))), _PARTS**2 * cells),
    ]


class _Caster(NamedTuple):
    """Casts a ray in each of some cells."""

    traced: Traced
    places: FloatArray
    normals: FloatArray
    random: np.random.Generator

    def __call__(self, leaves: _Leaves) -> Ends:
        """One ray in each."""
        where, cells = leaves
        sensor = where[0]
        at = (where[1:] + self.random.random((2, where.shape[1]))) * (2.0 / cells) - 1.0
        direction = _around(self.normals[sensor], *on_disc(*at))
        target, share = ends_of(*self.traced, self.places[sensor], direction)
        area = np.full(len(sensor), 1.0 / cells**2)
        return Ends(sensor, area, direction, target, share)


def _kind(target: NDArray[np.int32]) -> NDArray[np.int8]:
    """Whether rays see what stands in the scene, the sky, or open ground."""
    end = target[:, 0]
    return np.where(end == SKY, _ABOVE, np.where(end == OPEN_GROUND, _BELOW, _INSIDE)).astype(
        np.int8
    )


def _at_edges(low: NDArray[np.int8], high: NDArray[np.int8]) -> BoolArray:
    """Cells (S, n, n) around which not all is of one kind."""
    around = (1, 3, 3)
    return np.asarray(maximum_filter(high, around) != minimum_filter(low, around))


def _at_rim(high: NDArray[np.int8]) -> BoolArray:
    """Cells (S, n, n) that see beyond the scene at a grazing angle: a low sill may hide there."""
    rim = high != _INSIDE
    rim[:, 1:-1, 1:-1] = False
    return rim


def _refined(cells: NDArray) -> NDArray:
    """The same for the parts of cells (S, n, n)."""
    return np.repeat(np.repeat(cells, _PARTS, axis=1), _PARTS, axis=2)


def _around(normal: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
    """Unit vectors (R, 3) above points of the unit disc, around normals (R, 3).

    Duff et al. 2017, "Building an orthonormal basis, revisited".
    """
    z = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
    n0, n1, n2 = normal.T
    sign = np.where(n2 >= 0.0, 1.0, -1.0)
    a = -1.0 / (sign + n2)
    b = n0 * n1 * a
    return np.stack(
        [
            x * (1.0 + sign * n0**2 * a) + y * b + z * n0,
            x * sign * b + y * (sign + n1**2 * a) + z * n1,
            -x * sign * n0 - y * n1 + z * n2,
        ],
        axis=1,
    )

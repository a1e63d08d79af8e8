"""Rays of sensors and their ends. Rays pass glass by weight, at the angle at which they meet it.

A sensor's hemisphere, weighted by the cosine, is a square (Shirley and Chiu 1997), cut into cells
with one ray each. Cells whose neighbourhood sees both the scene and the sky or open ground are cut
into 4 x 4, and these again: an opening is found by its cells and then followed along its edge, so
that small openings are as accurate as large ones.
"""

import math
from typing import NamedTuple

import numpy as np
from light_transport.public import (
    MISS,
    RayScene,
    Tree,
    hot,
    inlined,
    met_row,
    mixed,
    nearest_along,
    scratch,
)
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, minimum_filter

from daylight_numbers.glazing.glass import Glass
from daylight_numbers.sky_cells import on_disc
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray, IntArray

# Ends that are not rows: sky, ground below the horizon, a body's back, and nothing.
SKY, OPEN_GROUND, BODY, NOTHING = -1, -2, -3, -4
# Number of panes after which a ray ends.
_MOST_PANES = 8
# Distance behind a pane at which a ray continues, in radii.
_BEHIND = 1e-5
# A cut cell has _PARTS x _PARTS parts.
_PARTS = 4
# Maximum number of cells along which an edge is followed.
_MOST_STEPS = 12
# Variance of one ray in a cell that an edge crosses at a random place.
_EDGE_VARIANCE = 1.0 / 6.0
_INSIDE, _ABOVE, _BELOW = 0, 1, 2


class GlazedScene(NamedTuple):
    """A scene, its tree, in which rays always meet glass, and its glass."""

    scene: RayScene
    tree: Tree
    glass: Glass


def glazed(scene: RayScene, glass: Glass) -> GlazedScene:
    """A scene with its glass."""
    opacity = np.where(glass.clear[scene.tree.order], np.float32(1.0), scene.tree.opacity)
    return GlazedScene(scene, scene.tree._replace(opacity=opacity.astype(np.float32)), glass)


def ends_of(
    where: GlazedScene, origin: FloatArray, direction: FloatArray
) -> tuple[np.ndarray, Float32Array]:
    """Ends of rays (R) that begin at `origin` (R, 3) in radii towards `direction` (R, 3), unit.

    Returns:
        Rows, SKY, OPEN_GROUND or BODY (R, 2) int32 that a ray ends at, and of the first pane that
        it met, or NOTHING; and the share (R, 2, 3) of either by colour.
    """
    target = np.empty((len(origin), 2), np.int32)
    share = np.zeros((len(origin), 2, 3), np.float32)
    receivers = where.scene.receivers
    first_group = len(receivers.texels.pixel) + len(receivers.probes.place)
    _ends(
        where.tree, receivers, first_group, where.glass, np.asarray(origin, float),
        np.asarray(direction, float), scratch(), target, share,
    )  # fmt: skip
    return target, share


@inlined
def _through(face, inner, panes):  # type: ignore[no-untyped-def]
    """Share of light of one polarisation that passes panes; see `glass.stack`."""
    passes = (1.0 - face) * (1.0 - face) * inner / (1.0 - face * face * inner * inner)
    back = face * (1.0 + inner * passes)
    through, returned = passes, back
    for _ in range(1, panes):
        between = 1.0 / (1.0 - returned * back)
        returned += through * through * back * between
        through *= passes * between
    return through


@inlined
def _passes(cosine, ior, panes, tint):  # type: ignore[no-untyped-def]
    """Share of unpolarised light that passes one face of a body, or panes; see `glass.stack`."""
    bent = math.sqrt(max(1.0 - (1.0 - cosine * cosine) / (ior * ior), 0.0))
    across = (cosine - ior * bent) / (cosine + ior * bent)
    along = (ior * cosine - bent) / (ior * cosine + bent)
    across, along = across * across, along * along
    if panes == 0:
        return tint * (1.0 - 0.5 * (across + along))
    inner = min(tint, 1.0) ** (1.0 / bent)
    both = _through(across, inner, panes) + _through(along, inner, panes)
    return 0.5 * max(tint, 1.0) * both


@hot
def _ends(tree, receivers, first_group, glass, origin, direction, scratch, target, share):  # type: ignore[no-untyped-def]
    geometry, texels, _, groups = receivers
    stack, far_stack, left, passed, place, _, _, ray = scratch
    for i in range(len(origin)):
        for k in range(3):
            place[k], ray[k], left[k] = origin[i, k], direction[i, k], 1.0
        target[i, 0], target[i, 1] = BODY, NOTHING
        for panes in range(_MOST_PANES):
            distance, hit, u, v = nearest_along(tree, place, ray, mixed(i, panes), stack, far_stack)
            if hit == MISS:
                target[i, 0] = SKY if ray[1] >= 0.0 else OPEN_GROUND
                break
            t = tree.order[hit]
            for k in range(3):
                place[k] += distance * ray[k]
            clear = glass.tint[t, 0] > 0.0 or glass.tint[t, 1] > 0.0 or glass.tint[t, 2] > 0.0
            if not clear or panes == _MOST_PANES - 1:
                met = met_row(geometry, texels, groups, first_group, t, u, v, place, ray)
                target[i, 0] = met if met >= 0 else BODY
                break
            faces = geometry.faces
            cosine = abs(faces[t, 0] * ray[0] + faces[t, 1] * ray[1] + faces[t, 2] * ray[2])
            through = 0.0
            for k in range(3):
                if k == 0 or glass.tint[t, k] != glass.tint[t, k - 1]:
                    through = _passes(
                        max(cosine, 1e-6), glass.ior[t], glass.panes[t], float(glass.tint[t, k])
                    )
                passed[k] = through
            if panes == 0:
                met = met_row(geometry, texels, groups, first_group, t, u, v, place, ray)
                target[i, 1] = met if met >= 0 else NOTHING
                for k in range(3):
                    share[i, 1, k] = 1.0 - passed[k]
            for k in range(3):
                left[k] *= passed[k]
                place[k] += _BEHIND * ray[k]
        for k in range(3):
            share[i, 0, k] = left[k]


class Ends(NamedTuple):
    """Where rays (R) end: their sensors (R,), the share (R,) of the sensor's hemisphere that each
    stands for, its direction (R, 3), target (R, 2) and colours (R, 2, 3), see `ends_of`."""

    sensor: IntArray
    area: FloatArray
    direction: FloatArray
    target: NDArray[np.int32]
    share: Float32Array


class _Leaves(NamedTuple):
    """Sensors, rows and columns (3, R) of squares that are cut into so many cells an edge."""

    where: NDArray[np.int64]
    cells: int


def sampled_ends(
    traced: GlazedScene,
    places: FloatArray,
    normals: FloatArray,
    cells: int,
    error: float,
    random: np.random.Generator,
) -> tuple[Ends, Ends]:
    """Ends of the rays of sensors at `places` (S, 3) in radii, with unit `normals` (S, 3): twice.

    Both halves have a ray in each cell. Other rays decide which cells are cut: rays that found or
    missed an edge would bias the result.

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

    traced: GlazedScene
    places: FloatArray
    normals: FloatArray
    random: np.random.Generator

    def __call__(self, leaves: _Leaves) -> Ends:
        """One ray in each."""
        where, cells = leaves
        sensor = where[0]
        at = (where[1:] + self.random.random((2, where.shape[1]))) * (2.0 / cells) - 1.0
        direction = around(self.normals[sensor], *on_disc(*at))
        target, share = ends_of(self.traced, self.places[sensor], direction)
        area = np.full(len(sensor), 1.0 / cells**2)
        return Ends(sensor, area, direction, target, share)


def _kind(target: NDArray[np.int32]) -> NDArray[np.int8]:
    """Kind of each ray's end: the scene, the sky, or open ground."""
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


def around(normal: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
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


# The share of the way to a lamp at which its own glass or the ceiling around it may begin.
_REACHED = 1.0 - 1e-4


def shares_between(where: GlazedScene, origin: FloatArray, end: FloatArray) -> Float32Array:
    """Share (R, 3) of light by colour that passes from `end` (R, 3) to `origin` (R, 3), in radii.

    Glass passes it by the angle at which the way meets it, anything else nothing.
    """
    share = np.zeros((len(origin), 3), np.float32)
    _shares_between(
        where.tree, where.scene.receivers.geometry.faces, where.glass, np.asarray(origin, float),
        np.asarray(end, float), scratch(), share,
    )  # fmt: skip
    return share


@hot
def _shares_between(tree, faces, glass, origin, end, scratch, share):  # type: ignore[no-untyped-def]
    stack, far_stack, left, _, place, _, _, ray = scratch
    for i in range(len(origin)):
        squared = 0.0
        for k in range(3):
            place[k], ray[k], left[k] = origin[i, k], end[i, k] - origin[i, k], 1.0
            squared += ray[k] * ray[k]
        length = math.sqrt(squared)
        ahead = _REACHED * length
        for k in range(3):
            ray[k] /= max(length, 1e-12)
        for panes in range(_MOST_PANES + 1):
            distance, hit, _, _ = nearest_along(tree, place, ray, mixed(i, panes), stack, far_stack)
            if hit == MISS or distance >= ahead:
                for k in range(3):
                    share[i, k] = left[k]
                break
            t = tree.order[hit]
            cosine = abs(faces[t, 0] * ray[0] + faces[t, 1] * ray[1] + faces[t, 2] * ray[2])
            passing = 0.0
            for k in range(3):
                tint = float(glass.tint[t, k])
                if tint > 0.0:
                    left[k] *= _passes(max(cosine, 1e-6), glass.ior[t], glass.panes[t], tint)
                else:
                    left[k] = 0.0
                passing += left[k]
                place[k] += (distance + _BEHIND) * ray[k]
            ahead -= distance + _BEHIND
            if passing == 0.0:
                break

"""Work planes that are found: level grids above the floors of rooms, or above open ground.

A floor is a level that many places with head room share. What of it one gets to at the height of
the plane without meeting a wall is a room where it lies under a roof and walls stand along half of
its outline; the rest is a court where walls and rooms around it hide most of the sky.
Where there is neither, the lowest large level is the ground.
"""

from typing import NamedTuple

import numpy as np
from light_transport.public import MISS, RayScene, first_hits
from numpy.typing import NDArray

from daylight_numbers.matrix.sensors import Sensors
from vrut_lite.errors import UserError
from vrut_lite.geometry.connected import connected_components
from vrut_lite.numeric_types import BoolArray, FloatArray

HEIGHT_M, STEP_M = 0.85, 0.5
# Distance to walls within which EN 17037 counts no sensors.
BORDER_M = 0.5
MOST_POINTS = 1_000
_HEAD_ROOM_M = 1.9
_SAME_FLOOR_M = 0.05
_LEAST_AREA_M2 = 2.0
_LEVEL = 0.95
_UP = np.array([0.0, 1.0, 0.0])
# Surfaces above each other that are looked at, from the top down.
_MOST_FLOORS = 24
_OFF = 1e-5
_AROUND = 16
# Share of directions upwards in which a place in the open sees fronts, or nothing.
_LEAST_OPEN = 0.75
_SINES = (0.15, 0.4, 0.65, 0.9)
# Share of a room's outline that is wall: the rest opens onto other floors, or ends. An awning has
# none, an arcade more than half.
_LEAST_WALL = 0.5
# Minimum share of a court's outline that is wall or room, and maximum share of sky above it.
_LEAST_WALL_OF_A_COURT, _MOST_SKY_OF_A_COURT = 0.95, 0.5
# Minimum floor area of rooms as a fraction of the scene's area; excludes huts and hollow trees.
_LEAST_ENCLOSED = 0.01
# Minimum area of the ground as a fraction of the largest level's.
_LEAST_GROUND = 0.1
# The finding of floors looks at so many places at least along the longer side.
_COARSE = 64
# A plain is looked over in so many cells at most.
_MOST_CELLS = 1_000_000


class _Hits(NamedTuple):
    """Distances (R,) in metres, infinite where nothing is met; whether a front is met (R,), and
    whether it is level (R,)."""

    distance_m: FloatArray
    front: BoolArray
    level: BoolArray


class _Floor(NamedTuple):
    """Places (N, 3) of a grid of `shape` over a level; `region` (N,) is -1 where none is free, and
    `sky` (N,) the share of directions upwards in which nothing is met."""

    kind: str
    level_m: float
    step_m: float
    at_m: FloatArray
    shape: tuple[int, int]
    region: NDArray[np.int64]
    sky: FloatArray


class _Look:
    """Casts rays in metres; they always meet glass and cut-outs."""

    def __init__(self, scene: RayScene):
        self._surfaces, self._faces = scene.surfaces, scene.receivers.geometry.faces
        self._tree = scene.tree._replace(opacity=np.ones_like(scene.tree.opacity))

    def __call__(self, places_m: FloatArray, towards: FloatArray) -> _Hits:
        """First hits of rays from places (R, 3) towards unit vectors (R, 3)."""
        radius = self._surfaces.radius_m
        direction = np.broadcast_to(np.asarray(towards, float), places_m.shape)
        origin = (places_m - self._surfaces.centre_m) / radius + _OFF * direction
        hit, distance = first_hits(self._tree, origin, np.ascontiguousarray(direction))
        met = hit != MISS
        faces = self._faces[np.where(met, hit, 0)]
        front = met & (np.einsum("ri,ri->r", faces, direction) < 0.0)
        found = np.where(met, distance.astype(float) * radius, np.inf)
        return _Hits(found, front, met & (np.abs(faces[:, 1]) > _LEVEL))


def work_planes(
    scene: RayScene,
    lower_m: FloatArray,
    upper_m: FloatArray,
    height_m: float = HEIGHT_M,
    step_m: float = STEP_M,
) -> Sensors:
    """Grids that face up, in cells of `step_m`; wider ones where there would be too many points.

    Raises:
        UserError: no floor with head room is found.
    """
    look = _Look(scene)
    lower_m, upper_m = np.asarray(lower_m, float), np.asarray(upper_m, float)
    extent = np.maximum(upper_m - lower_m, 1e-6)
    coarse = max(step_m, float(max(extent[0], extent[2])) / _COARSE)
    heights, has_roof = _floors(look, lower_m, upper_m, coarse)
    roofed, bare = _levels(heights[has_roof], coarse), _levels(heights[~has_roof], coarse)
    step_m = max(step_m, float(np.sqrt(extent[0] * extent[2] / _MOST_CELLS)))

    def floors(levels: list[float], kind: str, step: float) -> list[_Floor]:
        return [_floor(look, lower_m, upper_m, one, height_m, step, kind) for one in levels]

    least = _LEAST_ENCLOSED * len(heights)
    yards = [one for one in bare if _shared(heights[~has_roof], one) >= least]

    ground = _ground(_levels(heights, coarse), heights)

    def enclosed(step: float) -> list[_Floor]:
        rooms = [_walled(look, room, []) for room in floors(roofed, "room", step)]
        return rooms + [_walled(look, court, rooms) for court in floors(yards, "court", step)]

    def open_ground(step: float) -> list[_Floor]:
        return floors(ground, "open ground", step)

    def covered_ground(step: float) -> list[_Floor]:
        return floors(ground, "covered ground", step)

    large = _LEAST_ENCLOSED * extent[0] * extent[2]
    for find, least_m2 in ((enclosed, large), (open_ground, 0), (enclosed, 0), (covered_ground, 0)):
        step = step_m
        made = _sensors(look, find(step))
        while made is not None and len(made) > MOST_POINTS:
            step *= max(1.05, float(np.sqrt(len(made) / MOST_POINTS)))
            made = _sensors(look, find(step))
        if made is not None and len(made) * step**2 >= least_m2:
            return made
    raise UserError(
        f"no work plane is found in the scene: no level floor of {_LEAST_AREA_M2:g} m2 has "
        f"{_HEAD_ROOM_M:g} m of room above it, free at {height_m:g} m; give sensors as a file"
    )


def _columns(lower_m: FloatArray, upper_m: FloatArray, step_m: float) -> tuple[FloatArray, ...]:
    """Middles of cells along x and z, around the middle of the bounds."""
    found: list[FloatArray] = []
    for axis in (0, 2):
        count = max(1, int(np.ceil((upper_m[axis] - lower_m[axis]) / step_m)))
        middle = 0.5 * (lower_m[axis] + upper_m[axis])
        found.append(middle + (np.arange(count) - 0.5 * (count - 1)) * step_m)
    return tuple(found)


def _floors(
    look: _Look, lower_m: FloatArray, upper_m: FloatArray, step_m: float
) -> tuple[FloatArray, BoolArray]:
    """Heights (N,) of places with head room, and whether (N,) a roof is above them."""
    x, z = np.meshgrid(*_columns(lower_m, upper_m, step_m))
    top = float(upper_m[1]) + max(1.0, 0.01 * float(upper_m[1] - lower_m[1]))
    at = np.stack([x.ravel(), np.full(x.size, top), z.ravel()], axis=1)
    standing: list[tuple[FloatArray, BoolArray]] = []
    for _ in range(_MOST_FLOORS):
        below = look(at, -_UP)
        met = np.isfinite(below.distance_m)
        if not met.any():
            break
        at, below = at[met].copy(), _Hits(below.distance_m[met], below.front[met], below.level[met])
        at[:, 1] -= below.distance_m
        floor = below.front & below.level
        places = at[floor] + 1e-4 * _UP
        above = look(places, _UP)
        room = above.distance_m > _HEAD_ROOM_M
        # Within a body the next surface above is seen from its back.
        free = ~np.isfinite(above.distance_m) | above.front
        standing.append((places[room & free, 1], np.isfinite(above.distance_m[room & free])))
        at[:, 1] -= 1e-4
    heights = np.concatenate([heights for heights, _ in standing] or [np.empty(0)])
    has_roof = np.concatenate([roof for _, roof in standing] or [np.empty(0, bool)])
    return heights, has_roof


def _levels(heights: FloatArray, step_m: float) -> list[float]:
    """Heights that enough places share; one within head room of a larger floor is left out."""
    left = np.sort(heights)
    found: list[float] = []
    while len(left):
        counts = np.searchsorted(left, left + _SAME_FLOOR_M) - np.arange(len(left))
        best = int(np.argmax(counts))
        if counts[best] * step_m**2 < _LEAST_AREA_M2:
            break
        level = float(np.median(left[best : best + counts[best]]))
        if all(abs(level - other) > _HEAD_ROOM_M for other in found):
            found.append(level)
        left = np.delete(left, slice(best, best + counts[best]))
    return found


def _shared(heights: FloatArray, level: float) -> int:
    """How many places share a level."""
    return int(np.count_nonzero(np.abs(heights - level) <= _SAME_FLOOR_M))


def _ground(levels: list[float], heights: FloatArray) -> list[float]:
    """The lowest of levels that enough places share, or none."""
    shared = [_shared(heights, level) for level in levels]
    large = _LEAST_GROUND * max(shared, default=0)
    return sorted(level for level, count in zip(levels, shared, strict=True) if count >= large)[:1]


def _floor(
    look: _Look,
    lower_m: FloatArray,
    upper_m: FloatArray,
    level: float,
    height_m: float,
    step_m: float,
    kind: str,
) -> _Floor:
    """A grid over a level: a room's under a roof, open ground under none, a court under either."""
    x, z = np.meshgrid(*_columns(lower_m, upper_m, step_m))
    at = np.stack([x.ravel(), np.full(x.size, level + height_m), z.ravel()], axis=1)
    below, above = look(at, -_UP), look(at, _UP)
    free = below.front & (below.distance_m < height_m + 2.0 * _SAME_FLOOR_M)
    if kind == "open ground":
        free &= ~np.isfinite(above.distance_m)
    elif kind != "court":
        free &= above.front
    is_open, sky = np.zeros((2, len(at)))
    is_open[free], sky[free] = _upwards(look, at[free])
    free &= is_open >= _LEAST_OPEN
    region = _regions(look, at, free, x.shape, step_m)
    return _Floor(kind, level, step_m, at, x.shape, region, sky)


def _walled(look: _Look, floor: _Floor, rooms: list[_Floor]) -> _Floor:
    """A floor whose regions are rooms, or courts among walls and `rooms`; others become -1."""
    near = [one.region >= 0 for one in rooms if abs(one.level_m - floor.level_m) < _HEAD_ROOM_M]
    in_room = np.any(near, axis=0) if near else np.zeros(len(floor.at_m), bool)
    free = (floor.region >= 0) & ~in_room
    floor = floor._replace(region=_regions(look, floor.at_m, free, floor.shape, floor.step_m))
    share = _share_of_wall(look, floor, in_room)
    kept = share >= _LEAST_WALL
    if floor.kind == "court":
        here = floor.region[free]
        sky = np.bincount(here, floor.sky[free], len(share)) / np.bincount(here)
        kept = (share >= _LEAST_WALL_OF_A_COURT) & (sky <= _MOST_SKY_OF_A_COURT)
    return floor._replace(region=np.where(np.append(kept, False)[floor.region], floor.region, -1))


def _share_of_wall(look: _Look, floor: _Floor, shut: BoolArray) -> FloatArray:
    """Share of each region's outline where a wall stands, or where places (N,) are `shut`."""
    rows, columns = floor.shape
    count = int(floor.region.max(initial=-1)) + 1
    region = np.pad(floor.region.reshape(floor.shape), 1, constant_values=-1)
    others = np.pad(shut.reshape(floor.shape), 1)
    edges, walls = np.zeros((2, count))
    for down, right in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        beyond = slice(1 + down, 1 + down + rows), slice(1 + right, 1 + right + columns)
        edge = np.flatnonzero((floor.region >= 0) & (region[beyond].ravel() != floor.region))
        met = look(floor.at_m[edge], np.array([right, 0.0, down])).distance_m
        is_wall = (met < floor.step_m) | others[beyond].ravel()[edge]
        edges += np.bincount(floor.region[edge], minlength=count)
        walls += np.bincount(floor.region[edge], is_wall, minlength=count)
    return np.asarray(walls / np.maximum(edges, 1.0))


def _sensors(look: _Look, floors: list[_Floor]) -> Sensors | None:
    """A grid for each region that is large enough; None without such regions."""
    places, cells, planes = [], [], []
    names: list[str] = []
    numbers: dict[str, int] = {}
    for floor in floors:
        for number in range(int(floor.region.max(initial=-1)) + 1):
            here = np.flatnonzero(floor.region == number)
            if len(here) * floor.step_m**2 < _LEAST_AREA_M2:
                continue
            planes.append(np.full(len(here), len(names)))
            numbers[floor.kind] = numbers.get(floor.kind, 0) + 1
            names.append(f"{floor.kind} {numbers[floor.kind]}")
            places.append(floor.at_m[here])
            cells.append(np.stack(np.divmod(here, floor.shape[1]), axis=1))
    if not places:
        return None
    points = np.concatenate(places)
    return Sensors(
        points,
        np.tile([0.0, 1.0, 0.0], (len(points), 1)),
        np.concatenate(planes).astype(np.int64),
        np.concatenate(cells).astype(np.int64),
        _away_from_walls(look, points),
        tuple(names),
        (floors[0].step_m,) * len(names),
    )


def _regions(
    look: _Look, at: FloatArray, free: BoolArray, shape: tuple[int, ...], step_m: float
) -> NDArray[np.int64]:
    """The region (N,) of each place, -1 where it is not free; the largest first."""
    number = np.arange(len(at)).reshape(shape)
    pairs = []
    for one, other, towards in (
        (number[:, :-1], number[:, 1:], [1.0, 0.0, 0.0]),
        (number[:-1], number[1:], [0.0, 0.0, 1.0]),
    ):
        first, second = one.ravel(), other.ravel()
        both = free[first] & free[second]
        first, second = first[both], second[both]
        apart = look(at[first], np.array(towards)).distance_m < step_m
        pairs.append((first[~apart], second[~apart]))
    first, second = (np.concatenate(parts) for parts in zip(*pairs, strict=True))
    label = np.asarray(connected_components(len(at), first, second))
    label = np.where(free, label, -1)
    known, count = np.unique(label[free], return_counts=True)
    rank = {int(name): place for place, name in enumerate(known[np.argsort(-count, kind="stable")])}
    return np.array([rank.get(int(name), -1) for name in label], np.int64)


def _upwards(look: _Look, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shares (P,) of directions upwards in which points see a front or nothing, and nothing.

    Who lies in a body sees the backs of its walls.
    """
    fronts, nothing = np.zeros((2, len(points)))
    for turn in np.arange(_AROUND) * (2.0 * np.pi / _AROUND):
        for sine in _SINES:
            level = np.sqrt(1.0 - sine**2)
            met = look(points, np.array([level * np.cos(turn), sine, level * np.sin(turn)]))
            fronts += met.front
            nothing += ~np.isfinite(met.distance_m)
    count = _AROUND * len(_SINES)
    return (fronts + nothing) / count, nothing / count


def _away_from_walls(look: _Look, points: FloatArray) -> BoolArray:
    """Which points (P,) have no upright surface within BORDER_M around them."""
    inner = np.ones(len(points), bool)
    for turn in np.arange(_AROUND) * (2.0 * np.pi / _AROUND):
        met = look(points, np.array([np.cos(turn), 0.0, np.sin(turn)]))
        inner &= met.level | (met.distance_m >= BORDER_M)
    return inner

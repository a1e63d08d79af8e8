"""Rooms: the box around a work plane, and the openings of its sides, which are window groups.

Blinds hang in groups, a group a side. Where a scene has openings without panes, walls alone tell
where they are: what reaches a room from beyond a side came through the openings of that side.
"""

from typing import NamedTuple

import numpy as np
from light_transport.public import MISS, RayScene, first_hits
from numpy.typing import NDArray

from daylight_numbers.matrix.sensor_rays import glazed
from daylight_numbers.work import DaylightWork
from vrut_lite.numeric_types import FloatArray

SIDES = ("-x (west)", "+x (east)", "below", "roof", "-z (north)", "+z (south)")
BELOW, ROOF = 2, 3
# A room's side lies where at least this share of the level rays to it ends, or nearer: the others
# leave by openings.
_WALL_SHARE = 0.25
_SAME_PLANE, _OFF = 0.95, 1e-5
_FAR = 1e6
# Thickness of walls in metres: places in a wall count as within the room, and rays that end in it
# meet the wall.
_ON_WALL_M = 0.02
# Number of places by which an opening is represented.
_PLACES = 24
# Number of sensors that look for openings, and of rays from each.
_LOOKING, _RAYS = 48, 4096
# Minimum share of these rays through a side that has openings.
_LEAST_SHARE = 0.005
_LEAST_COSINE = 0.05


class RoomBox(NamedTuple):
    """Lower and upper corner (3,) of a room, in metres, world axes; `is_open` (6,): which of SIDES
    have openings, as far as that is known."""

    lower_m: FloatArray
    upper_m: FloatArray
    is_open: NDArray[np.bool_] = np.ones(len(SIDES), bool)

    def holds(self, places_m: FloatArray) -> NDArray[np.bool_]:
        """Which places (N, 3) lie within, or on its walls."""
        inside = (places_m > self.lower_m - _ON_WALL_M) & (places_m < self.upper_m + _ON_WALL_M)
        return np.asarray(inside.all(axis=-1))

    def exit_m(self, places_m: FloatArray, towards: FloatArray) -> FloatArray:
        """How far (N,) it is from places (N, 3) within along unit vectors (N, 3) to a side."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.where(towards > 0.0, self.upper_m, self.lower_m)
            ahead = np.where(towards == 0.0, np.inf, (ends - places_m) / towards)
        return np.asarray(np.maximum(ahead.min(axis=-1), 0.0))

    def side_of(self, places_m: FloatArray, towards: FloatArray) -> NDArray[np.int8]:
        """The open side (N,) by which straight ways from places (N, 3) towards directions leave."""
        place = np.clip(places_m, self.lower_m, self.upper_m)
        up = towards > 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            ahead = np.where(up, self.upper_m - place, self.lower_m - place) / towards
        # Places and directions are means, which may miss an opening beside a shut side.
        shut = ~self.is_open[2 * np.arange(3) + up]
        ahead = np.where(towards == 0.0, np.inf, np.where(shut, _FAR * (1.0 + ahead), ahead))
        axis = np.argmin(ahead, axis=-1)
        return np.asarray(
            2 * axis + np.take_along_axis(up, axis[..., None], axis=-1)[..., 0], np.int8
        )


def room_box(scene: RayScene, places_m: FloatArray, step_m: float) -> RoomBox | None:
    """The box around sensors (P, 3), half a cell of `step_m` beyond those where no wall is met.

    None where most have no roof above them.
    """
    radius, centre = scene.surfaces.radius_m, scene.surfaces.centre_m
    faces = scene.receivers.geometry.faces
    lower, upper = places_m.min(axis=0), places_m.max(axis=0)
    sides = lower.copy(), upper.copy()
    for axis in (1, 0, 2):
        for up in (False, True):
            direction = np.zeros(3)
            direction[axis] = 1.0 if up else -1.0
            towards = np.tile(direction, (len(places_m), 1))
            hit, distance = first_hits(
                scene.tree, (places_m - centre) / radius + _OFF * towards, towards
            )
            met = (hit != MISS) & (np.abs(faces[np.where(hit == MISS, 0, hit), axis]) > _SAME_PLANE)
            away = distance.astype(float) * radius * direction[axis]
            at = np.where(met, places_m[:, axis] + away, np.inf * direction[axis])
            edge = (upper if up else lower)[axis]
            beyond = at[at >= edge] if up else at[at <= edge]
            share = _WALL_SHARE if up else 1.0 - _WALL_SHARE
            found = np.quantile(beyond, share, method="nearest") if len(beyond) else np.inf
            if not np.isfinite(found):
                if axis == 1:
                    return None
                found = edge + 0.5 * step_m * direction[axis]
            sides[up][axis] = found
    return RoomBox(*sides)


def _sphere(count: int) -> FloatArray:
    """Unit vectors (count, 3), evenly spread on a spiral (Gonzalez 2010)."""
    y = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.arange(count) * np.pi * (3.0 - np.sqrt(5.0))
    level = np.sqrt(1.0 - y * y)
    return np.stack([level * np.cos(turn), y, level * np.sin(turn)], axis=1)


_SPHERE = _sphere(_RAYS)


class Opening(NamedTuple):
    """The openings of one of SIDES: places (N, 3) evenly spread over them in the plane of the side,
    the unit vector outwards (3,), and their area."""

    side: int
    places_m: FloatArray
    outwards: FloatArray
    area_m2: float


class DaylitRoom(NamedTuple):
    """A room: its box, which knows what sides are open, and their openings."""

    box: RoomBox
    openings: tuple[Opening, ...]

    @property
    def is_lit_by_roof(self) -> bool:
        """Whether most of its openings are in the roof."""
        area = sum(opening.area_m2 for opening in self.openings)
        return any(
            opening.side == ROOF and opening.area_m2 > 0.5 * area for opening in self.openings
        )


def room_of(work: DaylightWork, plane: int) -> DaylitRoom | None:
    """The room of a work plane; None where it has no roof or no openings."""
    here = work.sensors.plane == plane
    sensors = work.sensors.some(here)
    box = room_box(work.transport, sensors.places_m, work.sensors.step_m[plane])
    if box is None:
        return None
    openings = openings_of(DaylightWork(work.transport, work.glass, sensors, work.operator), box)
    if not openings:
        return None
    is_open = np.isin(np.arange(len(SIDES)), [opening.side for opening in openings])
    return DaylitRoom(box._replace(is_open=is_open), openings)


def openings_of(work: DaylightWork, box: RoomBox) -> tuple[Opening, ...]:
    """The openings of a room, by rays from some of its sensors in all directions."""
    transport = work.transport
    radius, centre = transport.surfaces.radius_m, transport.surfaces.centre_m
    count = len(work.sensors)
    looking = work.sensors.places_m[:: -(-count // _LOOKING)]
    place = np.repeat(looking, len(_SPHERE), axis=0)
    towards = np.tile(_SPHERE, (len(looking), 1))
    panes = work.operator.panes
    looked = glazed(transport, work.glass) if panes is None else panes.opened
    tree, clear = looked.tree, looked.glass.clear
    hit, distance = first_hits(
        tree._replace(opacity=np.where(clear[tree.order], np.float32(0), tree.opacity)),
        (place - centre) / radius,
        towards,
    )
    ahead = box.exit_m(place, towards)
    leaves = (hit == MISS) | (distance.astype(float) * radius > ahead + _ON_WALL_M)
    place, towards, ahead = place[leaves], towards[leaves], ahead[leaves]
    sides = box.side_of(place, towards)
    sight = 4.0 * np.pi / len(_SPHERE) / len(looking)
    found = []
    for side in range(len(SIDES)):
        here = sides == side
        if here.sum() <= max(_LEAST_SHARE * len(sides), 1):
            continue
        axis, up = divmod(side, 2)
        area = sight * ahead[here] ** 2 / np.maximum(np.abs(towards[here, axis]), _LEAST_COSINE)
        random = np.random.Generator(np.random.Philox(key=side))
        chosen = random.choice(len(area), _PLACES, p=area / area.sum())
        outwards = np.zeros(3)
        outwards[axis] = 1.0 if up else -1.0
        places = place[here][chosen] + ahead[here][chosen, None] * towards[here][chosen]
        found.append(Opening(side, places, outwards, float(area.sum())))
    return tuple(found)


def ground_shares(openings: tuple[Opening, ...], places_m: FloatArray) -> FloatArray:
    """Through which of the openings (G, N) places (N, 3) see open ground: shares.

    By the solid angle of each but those in roofs, whatever stands between.
    """
    found = np.zeros((len(openings), len(places_m)))
    for n, opening in enumerate(openings):
        if opening.side == ROOF and len(openings) > 1:
            continue
        away = opening.places_m - places_m[:, None]
        distance = np.linalg.norm(away, axis=-1) + 1e-6
        found[n] = np.mean(np.abs(away @ opening.outwards) / distance**3, axis=1) * opening.area_m2
    return np.asarray(found / np.maximum(found.sum(axis=0), 1e-12))

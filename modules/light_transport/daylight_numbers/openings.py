"""Where the openings of a room's sides are: where one looks out of it."""

from typing import NamedTuple

import numpy as np

from light_transport.daylight_numbers.room_box import ROOF, SIDES, RoomBox, room_box
from light_transport.daylight_numbers.sensor_rays import tree_with_glass
from light_transport.daylight_numbers.work import Work
from light_transport.rays.trace import MISS, first_hits
from vrut_lite.numeric_types import FloatArray

# An opening is looked through at so many places.
_PLACES = 24
# Rays from so many sensors look for openings, so many from each.
_LOOKING, _RAYS = 48, 4096
# A side by which a smaller share of these leaves has no openings.
_LEAST_SHARE = 0.005
_LEAST_COSINE = 0.05
# What is met so far behind a side still is its wall.
_ON_WALL_M = 0.02


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


class Room(NamedTuple):
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


def room_of(work: Work, plane: int) -> Room | None:
    """The room of a work plane; None where it has no roof or no openings."""
    here = work.sensors.plane == plane
    sensors = work.sensors.some(here)
    box = room_box(work.bake, sensors.places_m, work.sensors.step_m[plane])
    if box is None:
        return None
    openings = openings_of(Work(work.bake, work.glass, sensors, work.operator), box)
    if not openings:
        return None
    is_open = np.isin(np.arange(len(SIDES)), [opening.side for opening in openings])
    return Room(box._replace(is_open=is_open), openings)


def openings_of(work: Work, box: RoomBox) -> tuple[Opening, ...]:
    """The openings of a room, by rays from some of its sensors in all directions."""
    bake = work.bake
    radius, centre = bake.surfaces.radius_m, bake.surfaces.centre_m
    count = len(work.sensors)
    looking = work.sensors.places_m[:: -(-count // _LOOKING)]
    place = np.repeat(looking, len(_SPHERE), axis=0)
    towards = np.tile(_SPHERE, (len(looking), 1))
    tree = tree_with_glass(bake, work.glass)
    hit, distance = first_hits(
        tree._replace(opacity=np.where(work.glass.clear[tree.order], np.float32(0), tree.opacity)),
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

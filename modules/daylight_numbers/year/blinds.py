"""A year with blinds (IES LM-83-12): a group of them a side of a room.

A group is closed in hours in which more than 2 % of the room's sensors get 1,000 lx or more of
direct sun through it. Closed, it passes the share `transmittance` of the light on its openings,
evenly in all directions, and reflects nothing.
"""

from dataclasses import dataclass

import numpy as np
from light_transport.public import CancelCheck, always
from numpy.typing import NDArray

from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import Sensors, free_sensors
from daylight_numbers.rooms import SIDES, DaylitRoom, Opening, RoomBox
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.metrics import occupied
from daylight_numbers.year.side_light import side_light
from daylight_numbers.year.year import SolvedYear, Year, year_matrices, year_of
from daylight_numbers.year.year_light import YearLight
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

# IES LM-83-12: what 2 % of the points get of direct sun when occupants close blinds.
_SUN_LX, _SHARE_OF_POINTS = 1000.0, 0.02
# Transmittance of LM-83's fabric, the default.
TRANSMITTANCE = 0.05
# Distance before an opening, in metres, at which rays that measure its light begin.
_TOLERANCE, _BEFORE_M = 0.05, 1e-3


@dataclass(frozen=True, eq=False)
class Shaded:
    """A year of some sensors (P) with blinds.

    `total` (P, H) lux; `halves` by either half of the rays; `closed_h` hours from 8:00
    to 18:00 by group's name, in which its blinds are closed; none behind measured panes.
    """

    sensors: BoolArray
    total: Float32Array
    halves: tuple[Float32Array, Float32Array]
    closed_h: dict[str, int]


def shaded_year(
    work: DaylightWork,
    plane: int,
    room: DaylitRoom,
    year: Year,
    light: YearLight,
    solved: SolvedYear,
    transmittance: float = TRANSMITTANCE,
    go_on: CancelCheck = always,
) -> Shaded:
    """The year of one room, that of the work plane `plane`, with blinds.

    In a room with measured panes none hang: their files say what blinds do.

    Raises:
        GivenUp: by `go_on`.
    """
    here = work.sensors.plane == plane
    halves = year.halves[0][here], year.halves[1][here]
    if any(half.through[0][here].nnz for half in work.operator.halves):
        return Shaded(here, year.total[here], halves, {})
    sensors = work.sensors.some(here)
    box, openings = room
    part = DaylightWork(work.transport, work.glass, sensors, work.operator.some(here))
    sides = side_light(work.transport, part.operator, sensors, box, openings, solved)
    own = Year(year.total[here], year.sun[here], halves)
    sun_side = _sun_sides(box, sensors, own.sun, light)
    closed = np.stack([_is_closed(own.sun, sun_side == opening.side) for opening in openings])
    kept, whole = np.zeros((2, *own.total.shape), np.float32)
    let_in = np.zeros_like(kept)
    for group, opening in enumerate(openings):
        go_on()
        through = sides.of_year(group, light, solved)
        whole += through
        kept += through * ~closed[group]
        if closed[group].any():
            outside = _on_opening(part, opening, light, solved, go_on)
            radiance = transmittance * outside * closed[group] / np.pi
            let_in += sides.of_one[group][:, None] * radiance.astype(np.float32)
    share = np.where(whole > 0.0, kept / np.maximum(whole, 1e-9), 1.0)
    sun = own.sun * ~_stopped(closed, openings, sun_side)

    def with_blinds(total: Float32Array) -> Float32Array:
        return np.asarray(sun + (total - own.sun) * share + let_in, np.float32)

    shaded_halves = with_blinds(own.halves[0]), with_blinds(own.halves[1])
    hours = {
        SIDES[opening.side]: int(hours[occupied(light)].sum())
        for opening, hours in zip(openings, closed, strict=True)
    }
    return Shaded(here, with_blinds(own.total), shaded_halves, hours)


def _sun_sides(
    box: RoomBox, sensors: Sensors, sun: Float32Array, light: YearLight
) -> NDArray[np.int8]:
    """The side (P, H) by which the sun comes to sensors, -1 where it does not."""
    found = np.full(sun.shape, -1, np.int8)
    place, hour = np.nonzero(sun > 0.0)
    found[place, hour] = box.side_of(sensors.places_m[place], light.sun_direction[hour])
    return found


def _is_closed(sun: Float32Array, through: BoolArray) -> BoolArray:
    """Hours (H,) in which a group is closed by the sun (P, H) that comes through it."""
    bright = (sun >= _SUN_LX) & through
    return np.asarray(bright.mean(axis=0) > _SHARE_OF_POINTS)


def _stopped(
    closed: BoolArray, openings: tuple[Opening, ...], sun_side: NDArray[np.int8]
) -> BoolArray:
    """Where (P, H) the sun comes by a closed group."""
    stopped = np.zeros(sun_side.shape, bool)
    for opening, hours in zip(openings, closed, strict=True):
        stopped |= (sun_side == opening.side) & hours
    return stopped


def _on_opening(
    work: DaylightWork, opening: Opening, light: YearLight, solved: SolvedYear, go_on: CancelCheck
) -> FloatArray:
    """Lux (H,) that fall on the openings of a side from outside, behind their panes."""
    places = opening.places_m - _BEFORE_M * opening.outwards
    outwards = np.broadcast_to(opening.outwards, places.shape)
    sensors = free_sensors(places, outwards, SIDES[opening.side])
    operator = operator_of(
        work.transport, work.glass, sensors, _TOLERANCE, work.transport.threads, go_on
    )
    there = DaylightWork(work.transport, work.glass, sensors, operator)
    year = year_of(year_matrices(there, light, solved, go_on), light)
    return np.asarray(year.total.mean(axis=0, dtype=float))

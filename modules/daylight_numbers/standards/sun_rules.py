"""Rules of countries on the sun at windows: hours a day, on a day or on each day of a season.

* GB 50180-2018, table 4.0.9 (China): at the sill, 0.9 m above the floor, on the outer face of the
  wall, from 8 to 16 h true solar time on Dahan day (20 January), from 9 to 15 h at the winter
  solstice. Which line applies depends on climate zone and population.
* TNO's rules of 1962 (Netherlands): at the sill, on the inner face; the light one from 19 February
  to 21 October, the strict one from 21 January to 22 November. The Hague asks for the hours of the
  light one on the facade, by sun above 10 degrees.
* DIN 5034-1:2011 (Germany): in the plane of the facade, sun above 6 degrees, on 17 January and at
  the equinox.

A window is a place in the openings of a side of a room: the best one counts. Sunlight is possible
sunlight: clouds do not count.
"""

from collections.abc import Sequence
from datetime import date
from typing import NamedTuple

import numpy as np

from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.rooms import BELOW, ROOF, SIDES, DaylitRoom, Opening
from daylight_numbers.standards.compliance import Clause, met_text
from daylight_numbers.standards.sun_days import SunSteps, sun_by_day, sun_steps
from daylight_numbers.standards.sun_hours import BEFORE_M
from daylight_numbers.standards.windows import ShutScene, outer_places, shut_scene
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.year_light import YEAR
from vrut_lite.messages.place import SetPlace
from vrut_lite.numeric_types import FloatArray

# Height of a sill above the floor where a side's openings reach lower.
_SILL_M = 0.9
_ROUNDING_H = 1e-6


class SunRule(NamedTuple):
    """Least hours of sun a day from the first to the last day (month and day), by sun above an
    elevation and, in true solar time, between two hours; on the outer or the inner face."""

    name: str
    hours: float
    first: tuple[int, int]
    last: tuple[int, int]
    is_outside: bool
    least_elevation_deg: float = 0.0
    solar_time_h: tuple[float, float] = (0.0, 24.0)

    @property
    def asks(self) -> str:
        """The requirement in words."""
        days = f"on {_day(*self.first)}"
        if self.last != self.first:
            days = f"each day from {_day(*self.first)} to {_day(*self.last)}"
        above = f", sun above {self.least_elevation_deg:g}°" if self.least_elevation_deg else ""
        from_h, to_h = self.solar_time_h
        between = f", {from_h:g} to {to_h:g} h solar time" if to_h < 24.0 else ""
        return f"{self.hours:g} h {days}{above}{between}"


_DAHAN, _SOLSTICE, _WINTER, _EQUINOX = (1, 20), (12, 21), (1, 17), (3, 21)
RULES = (
    SunRule("GB 50180 zones I to III, VII, large cities", 2.0, _DAHAN, _DAHAN, True, 0.0, (8, 16)),
    SunRule("GB 50180 the same, small; IV, large", 3.0, _DAHAN, _DAHAN, True, 0.0, (8, 16)),
    SunRule("GB 50180 zones V, VI; IV, small", 1.0, _SOLSTICE, _SOLSTICE, True, 0.0, (9, 15)),
    SunRule("TNO, light", 2.0, (2, 19), (10, 21), False),
    SunRule("TNO, strict", 3.0, (1, 21), (11, 22), False),
    SunRule("The Hague", 2.0, (2, 19), (10, 21), True, 10.0),
    SunRule("DIN 5034-1, winter", 1.0, _WINTER, _WINTER, True, 6.0),
    SunRule("DIN 5034-1, equinox", 4.0, _EQUINOX, _EQUINOX, True, 6.0),
)


class RuleFound(NamedTuple):
    """Hours of sun of the best place in a side's openings on the rule's day with least sun."""

    rule: SunRule
    side: int
    hours: float
    day: date


def rules_of_room(
    work: DaylightWork, room: DaylitRoom, place: SetPlace, offset_h: float
) -> list[RuleFound]:
    """All rules at each upright side of a room that has openings."""
    steps = sun_steps(place, offset_h, date(YEAR, 1, 1), date(YEAR, 12, 31))
    outside = shut_scene(work)
    found = []
    for opening in room.openings:
        if opening.side in (ROOF, BELOW):
            continue
        at_sill = above_sill(opening, room)
        places = outer_places(outside, at_sill)
        for rule in RULES:
            first, last = (date(YEAR, *day) for day in (rule.first, rule.last))
            asked = _within(steps, rule, first, last)
            hours = (
                outer_hours(outside, places, opening.outwards, asked)
                if rule.is_outside
                else inner_hours(work, at_sill, asked)
            )[:, (first - steps.first).days : (last - steps.first).days + 1]
            best = hours[np.argmax(hours.min(axis=1))]
            day = int(np.argmin(best)) + (first - steps.first).days
            found.append(RuleFound(rule, opening.side, float(best.min()), steps.date_of(day)))
    return found


def above_sill(opening: Opening, room: DaylitRoom) -> Opening:
    """An opening's places that are at least as high as a sill; all where none is."""
    high = opening.places_m[:, 1] >= room.box.lower_m[1] + _SILL_M
    return opening._replace(places_m=opening.places_m[high]) if high.any() else opening


def outer_hours(
    scene: ShutScene, places_m: FloatArray, outwards: FloatArray, steps: SunSteps
) -> FloatArray:
    """Hours (N, D) of sun at places (N, 3) on the outer face of a wall."""
    ahead = steps.some(steps.towards @ outwards > 0.0)
    if not len(ahead.day):
        return np.zeros((len(places_m), steps.days))
    return ahead.hours(np.array([scene.reaches(at, ahead.towards) for at in places_m]))


def inner_hours(work: DaylightWork, opening: Opening, steps: SunSteps) -> FloatArray:
    """Hours (N, D) of sun at an opening's places on the inner face, through its glass."""
    places = opening.places_m - BEFORE_M * opening.outwards
    outwards = np.broadcast_to(opening.outwards, places.shape)
    return sun_by_day(work, free_sensors(places, outwards, "opening"), steps)


def rule_clauses(name: str, found: Sequence[RuleFound]) -> list[Clause]:
    """Rows of a room."""
    return [
        Clause(
            one.rule.name,
            f"{name}, {SIDES[one.side]}",
            one.rule.asks,
            f"{one.hours:.1f} h on {one.day:%-d %B}",
            met_text(one.hours >= one.rule.hours - _ROUNDING_H),
        )
        for one in found
    ]


def _within(steps: SunSteps, rule: SunRule, first: date, last: date) -> SunSteps:
    """The steps that a rule counts."""
    from_h, to_h = rule.solar_time_h
    return steps.some(
        (steps.day >= (first - steps.first).days)
        & (steps.day <= (last - steps.first).days)
        & (steps.elevation_deg > rule.least_elevation_deg)
        & (steps.solar_time_h >= from_h)
        & (steps.solar_time_h <= to_h)
    )


def _day(month: int, day: int) -> str:
    return f"{date(YEAR, month, day):%-d %B}"

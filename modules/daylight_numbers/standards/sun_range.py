"""Hours of sun a day over a range of dates: columns of sensors, and a table of planes and windows.

Possible sun: clouds do not count. A window is the place in the openings of a side that has most sun
in the mean, on the outer face of the wall.
"""

import re
from collections.abc import Mapping
from datetime import date
from typing import NamedTuple

import numpy as np

from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.report import Table
from daylight_numbers.rooms import BELOW, ROOF, SIDES, DaylitRoom
from daylight_numbers.standards.sun_days import SunSteps, sun_by_day, sun_steps
from daylight_numbers.standards.sun_rules import above_sill, outer_hours
from daylight_numbers.standards.windows import outer_places, shut_scene
from daylight_numbers.work import DaylightWork
from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray

_DATES = re.compile(r"(\d{4}-\d\d-\d\d)\.\.(\d{4}-\d\d-\d\d)", re.ASCII)
_MOST_DAYS = 366
# Years in which the sun's formula holds (`vrut_lite.sky.suns`).
_YEARS = (1950, 2050)


class SunRange(NamedTuple):
    """The first and the last day."""

    first: date
    last: date


def parse_sun_range(text: str) -> SunRange:
    """A range as FIRST..LAST, two dates.

    Raises:
        UserError: it is no range, runs backwards, is longer than a year, or lies outside 1950-2050.
    """
    match = _DATES.fullmatch(text.strip())
    try:
        if match is None:
            raise ValueError
        first, last = date.fromisoformat(match[1]), date.fromisoformat(match[2])
    except ValueError:
        raise UserError(
            f"--sun-range {text} is no range of days: write 2026-02-08..2026-10-20"
        ) from None
    if last < first or (last - first).days >= _MOST_DAYS:
        raise UserError(f"--sun-range {text} runs from an earlier to a later day, a year at most")
    if first.year < _YEARS[0] or last.year > _YEARS[1]:
        raise UserError(f"--sun-range {text} lies outside the years {_YEARS[0]} to {_YEARS[1]}")
    return SunRange(first, last)


def sun_range_pages(
    work: DaylightWork, opened: OpenedScene, rooms: Mapping[int, DaylitRoom], asked: SunRange
) -> tuple[dict[str, FloatArray], Table]:
    """Columns (P,) of hours a day in the mean, on the day with least and on that with most sun, and
    a table of planes, in the mean over their sensors, and of windows."""
    steps = sun_steps(opened.place, opened.standard_offset_h, *asked)
    by_day = sun_by_day(work, work.sensors, steps)
    columns = {
        "sun_range_mean_h": by_day.mean(axis=1),
        "sun_range_least_h": by_day.min(axis=1),
        "sun_range_most_h": by_day.max(axis=1),
    }
    rows = [
        _row(name, by_day[work.sensors.plane == plane].mean(axis=0), steps)
        for plane, name in enumerate(work.sensors.names)
    ]
    scene = shut_scene(work)
    for plane, room in rooms.items():
        for opening in room.openings:
            if opening.side in (ROOF, BELOW):
                continue
            places = outer_places(scene, above_sill(opening, room))
            hours = outer_hours(scene, places, opening.outwards, steps)
            best = hours[np.argmax(hours.mean(axis=1))]
            rows.append(_row(f"{work.sensors.names[plane]}, {SIDES[opening.side]}", best, steps))
    heading = f"Hours of sun a day, {asked.first:%-d %B %Y} to {asked.last:%-d %B %Y}"
    return columns, Table(heading, ["of", "mean", "least", "on", "most", "on"], rows)


def _row(name: str, by_day: FloatArray, steps: SunSteps) -> list[str]:
    least, most = int(np.argmin(by_day)), int(np.argmax(by_day))
    return [
        name,
        f"{by_day.mean():.1f}",
        f"{by_day[least]:.1f}",
        f"{steps.date_of(least):%-d %b}",
        f"{by_day[most]:.1f}",
        f"{steps.date_of(most):%-d %b}",
    ]

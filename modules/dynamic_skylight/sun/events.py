"""Sunrise, noon, sunset and the twilights of a day.

They are roots of `sun_position`, by the conventions of almanacs:

* Sunrise and sunset: the upper limb, with the refraction at its elevation, is on a level
  horizon. (Refraction grows downwards, so a round disc about the refracted centre appears some
  seconds earlier.) For an observer at a height the thinner air counts, the dip of the horizon
  does not.
* Twilights: the geometric elevation of the centre is -6 (civil), -12 (nautical) or -18 deg
  (astronomical).

Any event may be missing: near the poles the sun stays up or down for months.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, date, datetime, time, timedelta, tzinfo
from functools import cache
from itertools import pairwise
from typing import get_args

import numpy as np

from dynamic_skylight.sun.disc import MEAN_ANGULAR_RADIUS_RAD
from dynamic_skylight.sun.position import Method, SunPosition, checked_place, position_at
from vrut_lite.arguments import FIRST_YEAR, LAST_YEAR, check_choice, check_type, shown
from vrut_lite.atmosphere.refraction import pressure_at_altitude_pa, refraction_of_true_rad

# Between two samples the sun moves 7.5 deg; extremes in between are searched for.
_LOOK = timedelta(minutes=30)
_PRECISION = timedelta(milliseconds=10)
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
_TWILIGHTS_DEG = {"civil": -6.0, "nautical": -12.0, "astronomical": -18.0}

Height = Callable[[datetime], float]


@dataclass(frozen=True)
class SunEvents:
    """The sun's events of one civil day in order, as aware datetimes; None if one is missing."""

    astronomical_dawn: datetime | None
    nautical_dawn: datetime | None
    civil_dawn: datetime | None
    sunrise: datetime | None
    noon: datetime | None
    sunset: datetime | None
    civil_dusk: datetime | None
    nautical_dusk: datetime | None
    astronomical_dusk: datetime | None


def sun_events(
    day: date,
    latitude_deg: float,
    longitude_deg: float,
    *,
    time_zone: tzinfo = UTC,
    altitude_m: float = 0.0,
    method: Method = "ephemeris",
) -> SunEvents:
    """The sun's events at a place from midnight to midnight of a civil day of a time zone.

    Where an event happens twice in the day (a midsummer sunset just after one midnight and
    again just before the next) the dawns and sunrise are the first, sunset and the dusks the
    last. Noon is the upper transit of the meridian; at a pole, that of the longitude given.
    Times are good to 0.01 s of this sun's own motion; refraction makes real sunrises differ by
    a minute and more.

    Args:
        day: of the years 1600 to 2600.
        time_zone: whose midnights begin and end the day.

    The place and `method` are those of `sun_position`.

    Raises:
        ValueError: for a day or a place out of range, in one sentence.
    """
    _check_day(day)
    check_type("time_zone", time_zone, tzinfo)
    check_choice("method", method, get_args(Method))
    latitude_deg, longitude_deg, altitude_m = checked_place(latitude_deg, longitude_deg, altitude_m)

    @cache
    def look(when: datetime) -> SunPosition:
        return position_at(when, latitude_deg, longitude_deg, method, altitude_m)

    start, end = _midnight(day, time_zone), _midnight(day + timedelta(days=1), time_zone)
    # One sample beyond each end, to find extremes in the day's first or last minutes.
    looks = [start - _LOOK, *_looks(start, end), end, end + _LOOK]
    turning = _with_extremes(looks, lambda when: look(when).elevation_rad)
    instants = [when for when in turning if start <= when <= end]

    def crossings(height: Height, rising: bool) -> list[datetime]:
        return [when.astimezone(time_zone) for when in _roots(instants, height, rising)]

    def upper_limb(when: datetime) -> float:
        limb = look(when).elevation_rad + MEAN_ANGULAR_RADIUS_RAD
        return limb + float(refraction_of_true_rad(limb, pressure_at_altitude_pa(altitude_m)))

    def eastward(when: datetime) -> float:
        return look(when).direction[0]

    found = {
        "sunrise": _first(crossings(upper_limb, rising=True)),
        "noon": _first(crossings(eastward, rising=False)),
        "sunset": _last(crossings(upper_limb, rising=False)),
    }
    for name, elevation_deg in _TWILIGHTS_DEG.items():
        height = _above(look, float(np.radians(elevation_deg)))
        found[f"{name}_dawn"] = _first(crossings(height, rising=True))
        found[f"{name}_dusk"] = _last(crossings(height, rising=False))
    return SunEvents(**found)


def _check_day(day: date) -> None:
    # A datetime is also a date, but in the time zone it may fall on another day.
    if isinstance(day, datetime) or not isinstance(day, date):
        raise ValueError(f"day must be a date, as date(2026, 6, 21), not {shown(day)}")
    if not FIRST_YEAR <= day.year <= LAST_YEAR:
        raise ValueError(f"day must be of the years {FIRST_YEAR} to {LAST_YEAR}, not {day}")


def _above(look: Callable[[datetime], SunPosition], elevation_rad: float) -> Height:
    return lambda when: look(when).elevation_rad - elevation_rad


def _midnight(day: date, time_zone: tzinfo) -> datetime:
    """The day's beginning in UTC, which has no changes of clocks."""
    return datetime.combine(day, time(), tzinfo=time_zone).astimezone(UTC)


def _looks(start: datetime, end: datetime) -> Iterator[datetime]:
    while start < end:
        yield start
        start += _LOOK


def _with_extremes(instants: list[datetime], height: Height) -> list[datetime]:
    """The instants and the extremes between them, between which the height is monotone."""
    heights = [height(when) for when in instants]
    extremes = []
    for i in range(1, len(instants) - 1):
        before, here, after = heights[i - 1 : i + 2]
        if (here - before) * (after - here) <= 0.0:
            sign = 1.0 if here >= before else -1.0
            extremes.append(_highest(instants[i - 1], instants[i + 1], height, sign))
    return sorted({*instants, *extremes})


def _highest(start: datetime, end: datetime, height: Height, sign: float) -> datetime:
    """The instant at which sign times height is largest, by golden-section search."""
    while end - start > timedelta(seconds=1):
        width = _GOLDEN * (end - start)
        left, right = end - width, start + width
        if sign * height(left) < sign * height(right):
            start = left
        else:
            end = right
    return start + (end - start) / 2


def _roots(instants: list[datetime], height: Height, rising: bool) -> Iterator[datetime]:
    """The instants at which the height passes zero, upwards or downwards."""
    sign = 1.0 if rising else -1.0
    heights = [sign * height(when) for when in instants]
    for (start, end), (low, high) in zip(pairwise(instants), pairwise(heights), strict=True):
        if low < 0.0 <= high:
            yield _root(start, end, height, sign)


def _root(start: datetime, end: datetime, height: Height, sign: float) -> datetime:
    """The instant at which sign times height becomes positive, by bisection."""
    while end - start > _PRECISION:
        middle = start + (end - start) / 2
        if sign * height(middle) < 0.0:
            start = middle
        else:
            end = middle
    return end


def _first(instants: list[datetime]) -> datetime | None:
    return instants[0] if instants else None


def _last(instants: list[datetime]) -> datetime | None:
    return instants[-1] if instants else None

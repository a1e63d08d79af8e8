"""Sunrise, noon, sunset and the twilights of a day at a place, by `sun_position`."""

from dataclasses import dataclass
from datetime import UTC, date, datetime, tzinfo
from typing import get_args

from dynamic_skylight.sun.position import Method, SunPosition, checked_place, position_at
from vrut_lite.arguments import FIRST_YEAR, LAST_YEAR, check_choice, check_type, shown
from vrut_lite.sky.day_events import DAY_EVENTS, civil_day, day_events


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

    `vrut_lite.sky.day_events` defines them.

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

    def sun_at(when: datetime) -> SunPosition:
        return position_at(when, latitude_deg, longitude_deg, method, altitude_m)

    found = day_events(*civil_day(day, time_zone), sun_at, altitude_m)
    local = {name: when.astimezone(time_zone) for name, when in found.items()}
    return SunEvents(*(local.get(name) for name in DAY_EVENTS))


def _check_day(day: date) -> None:
    # A datetime is also a date, but in the time zone it may fall on another day.
    if isinstance(day, datetime) or not isinstance(day, date):
        raise ValueError(f"day must be a date, as date(2026, 6, 21), not {shown(day)}")
    if not FIRST_YEAR <= day.year <= LAST_YEAR:
        raise ValueError(f"day must be of the years {FIRST_YEAR} to {LAST_YEAR}, not {day}")

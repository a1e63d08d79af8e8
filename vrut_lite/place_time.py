"""Parses places and times from text, and writes instants as captions.

A time without an offset is civil time at the place, by the time zone of its coordinates, never by
its longitude. A time that clocks there skip or show twice is refused, and the error names both
instants that it could mean.
"""

import math
import re
from datetime import UTC, datetime, tzinfo
from typing import NamedTuple
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from vrut_lite.arguments import FIRST_YEAR, LAST_YEAR
from vrut_lite.errors import UserError
from vrut_lite.messages.place import HIGHEST_M, LOWEST_M, SetPlace
from vrut_lite.plain_numbers import plain_float
from vrut_lite.time_zone_names import zone_name

_PLACE_EXAMPLE = "write latitude,longitude in degrees, north and east positive, as 50.0755,14.4378"
_TIME_EXAMPLE = "write 2026-06-21T18:30 for local time, or 2026-06-21T18:30+02:00"
_TIME = re.compile(
    r"(?P<date>\d{4}-\d\d-\d\d)[T ](?P<clock>\d\d:\d\d(:\d\d(\.\d{1,6})?)?)"
    r" ?(?P<offset>Z|[+-]\d\d(:?[0-5]\d(:[0-5]\d)?)?)?",
    re.ASCII | re.IGNORECASE,
)


class Place(NamedTuple):
    """A point on or above the Earth: degrees, north and east positive, metres above the sea."""

    latitude_deg: float
    longitude_deg: float
    altitude_m: float = 0.0


def parse_place(text: str) -> Place:
    """The place that "latitude,longitude" or "latitude,longitude,altitude" names.

    Raises:
        UserError: the text has another form, or a number lies outside its range.
    """
    try:
        numbers = [plain_float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3):
        raise UserError(f"'{text}' is no place: {_PLACE_EXAMPLE}, and altitude in metres third")
    place = Place(*numbers)
    _require("latitude", place.latitude_deg, -90.0, 90.0, "degrees", text)
    _require("longitude", place.longitude_deg, -180.0, 180.0, "degrees, east positive", text)
    _require("altitude", place.altitude_m, LOWEST_M, HIGHEST_M, "metres", text)
    return place


def _require(name: str, value: float, low: float, high: float, unit: str, text: str) -> None:
    # Written so that NaN fails the comparison too.
    if not low <= value <= high:
        raise UserError(
            f"the {name} {value:g} of the place '{text}' lies outside "
            f"{low:.0f} to {high:.0f} {unit}"
        )


def time_zone_at(place: Place) -> ZoneInfo:
    """The civil time zone of the place, or the nautical zone where the map has none.

    The nautical zone follows the longitude: the whole hours nearest to solar time.

    Raises:
        UserError: the machine has no time zone data.
    """
    name = zone_name(place.longitude_deg, place.latitude_deg)
    name = name or _nautical_zone(place.longitude_deg)
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, OSError):
        raise UserError(
            f"this machine does not know the time zone {name}: install the Python package tzdata"
        ) from None


def _nautical_zone(longitude_deg: float) -> str:
    # Etc names count hours west of Greenwich: Etc/GMT-1 is an hour ahead.
    hours_west = -math.floor(longitude_deg / 15.0 + 0.5)
    return f"Etc/GMT{hours_west:+d}" if hours_west else "Etc/GMT"


def parse_instant(text: str, place: Place) -> datetime:
    """The instant in UTC of an ISO 8601 date and time, local at the place if without an offset.

    Raises:
        UserError: the text is malformed, names a date or hour that does not exist, lies outside
            the years FIRST_YEAR to LAST_YEAR, or is a local time that the place's clocks skip or
            show twice (the sentence names both readings).
    """
    when = _date_and_time(text)
    if not FIRST_YEAR <= when.year <= LAST_YEAR:
        raise UserError(
            f"the year {when.year} of '{text}' lies outside {FIRST_YEAR} to {LAST_YEAR}, "
            "the years that the sun is followed through"
        )
    if when.tzinfo is None:
        when = _localized(when, time_zone_at(place))
    return when.astimezone(UTC)


def _date_and_time(text: str) -> datetime:
    """The date and time of the text, aware only if it carries an offset.

    datetime.fromisoformat alone accepts more forms, and different ones in each Python version.
    """
    match = _TIME.fullmatch(text.strip())
    if not match:
        raise UserError(f"'{text}' is no date and time: {_TIME_EXAMPLE}")
    date, clock, offset = match["date"], match["clock"], match["offset"] or ""
    # Newer Pythons accept 24:00 as the end of the day, older ones do not.
    if clock.startswith("24"):
        raise UserError(f"'{text}' has the hour 24: write 00:00 of the next day")
    try:
        return datetime.fromisoformat(f"{date}T{clock}{offset.upper()}")
    except ValueError:
        raise UserError(
            f"'{text}' has a date, hour or offset that does not exist: {_TIME_EXAMPLE}"
        ) from None


def _localized(wall: datetime, zone: ZoneInfo) -> datetime:
    """The one aware time at which clocks of the zone show the naive time `wall`.

    `fold` selects the offset before (0) or after (1) a change of the clocks (PEP 495). Converted
    to UTC and back, an existing time is unchanged; a skipped one changes with either offset.
    """
    readings = [wall.replace(tzinfo=zone, fold=fold).astimezone(UTC) for fold in (0, 1)]
    if readings[0] == readings[1]:
        return readings[0]
    first, second = (_offset_text(reading.astimezone(zone)) for reading in sorted(readings))
    exists = readings[0].astimezone(zone).replace(tzinfo=None, fold=0) == wall
    happens = "twice" if exists else "never"
    raise UserError(
        f"clocks of {zone.key} show {wall.isoformat(' ', _precision(wall))} {happens}, "
        f"as they are changed then: write {first} or {second}"
    )


def same_hour_elsewhere(instant: datetime, here: Place, there: Place) -> datetime:
    """The instant in UTC at which clocks there show what clocks here show at an instant.

    An hour that clocks there skip becomes the one after it; of one that they show twice it is the
    first.
    """
    shown = instant.astimezone(time_zone_at(here)).replace(tzinfo=None, fold=0)
    return shown.replace(tzinfo=time_zone_at(there)).astimezone(UTC)


def _offset_text(when: datetime) -> str:
    return when.isoformat("T", _precision(when))


def _precision(when: datetime) -> str:
    return "auto" if when.second or when.microsecond else "minutes"


def local_text(instant: datetime, place: Place) -> str:
    """The instant in local time for captions: "2026-06-21 18:30 CEST".

    Zones without an abbreviation are named by their offset, as UTC+03:00.

    Raises:
        ValueError: the instant is naive.
    """
    if instant.tzinfo is None:
        raise ValueError(f"the instant {instant} needs a time zone: a naive time names none")
    local = instant.astimezone(time_zone_at(place)).replace(microsecond=0)
    clock = local.replace(tzinfo=None)
    name = local.tzname() or ""
    if not name.isalpha():
        name = "UTC" + local.isoformat().removeprefix(clock.isoformat())
    return f"{clock.isoformat(' ', _precision(clock))} {name}"


def second_of_day(instant: datetime, place: SetPlace | None) -> float:
    """Seconds since midnight on the clocks of a place; UTC without one."""
    zone: tzinfo = UTC
    if place is not None:
        where = Place(place.latitude_deg, place.longitude_deg, place.altitude_m)
        zone = time_zone_at(where)
    local = instant.astimezone(zone)
    return 3600.0 * local.hour + 60.0 * local.minute + local.second + 1e-6 * local.microsecond

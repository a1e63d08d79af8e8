"""A span of time in steps, and the numbered files of its pictures."""

import re
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, NamedTuple

import click
import msgspec

from vrut_lite.arguments import shown
from vrut_lite.errors import UserError
from vrut_lite.place_time import FIRST_YEAR, Place, parse_instant, time_zone_at
from vrut_lite.project import Project

MOST_PICTURES = 100_000
SHORTEST_STEP_S = 1.0
_CLOCK = re.compile(r"\d\d:\d\d(:\d\d)?", re.ASCII)
_STEP = re.compile(r"(\d+(?:\.\d+)?) ?(s|m|min|h)?", re.ASCII)
_SECONDS = {"s": 1.0, "m": 60.0, "min": 60.0, "h": 3600.0, None: 60.0}
_NUMBER = re.compile(r"%(\d*)d", re.ASCII)
# Names of files have at most 255 bytes.
_MOST_DIGITS = 99


class Wanted(NamedTuple):
    """A picture to be made."""

    instant: datetime
    path: Path


def span_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --from, --to and --step."""
    for option in (
        click.option("--step", metavar="TIME", help="... in steps of so long: 30s, 10m (the "
                     "default), 1h."),
        click.option("--to", "end", metavar="TIME", help="... to here, the end included."),
        click.option("--from", "start", metavar="TIME", help="A picture for each step from here, "
                     "to FILES as day_%04d.png: a clock time on the day of --at, or as --at ..."),
    ):  # fmt: skip
        command = option(command)
    return command


def wanted_pictures(output: str, project: Project, options: dict[str, Any]) -> list[Wanted]:
    """The pictures to make: one, or those of a span; removes its keys from `options`.

    Raises:
        UserError: the span is empty or too long, or the name has no number.
    """
    start, end, step = (options.pop(key) for key in ("start", "end", "step"))
    if start is None and end is None:
        if step is not None:
            raise UserError("--step needs --from and --to: pictures of a span of time")
        return [Wanted(project.instant(), Path(output))]
    if start is None or end is None:
        raise UserError("--from and --to go together: a span of time from one to the other")
    instants = _instants(project, start, end, _step(step or "10m"))
    _check_pattern(output)
    paths = [_numbered(output, number + 1) for number in range(len(instants))]
    return [Wanted(*pair) for pair in zip(instants, paths, strict=True)]


def _instants(project: Project, start: str, end: str, step: timedelta) -> list[datetime]:
    first, last = (_instant(text, project) for text in (start, end))
    if last < first:
        hint = "" if len(end) > len("00:00:00") else ", with its date if it is of the next day"
        raise UserError(f"--to {end} comes before --from {start}: name a later time{hint}")
    count = (last - first) // step + 1
    if count > MOST_PICTURES:
        raise UserError(
            f"from {start} to {end} there are {count} steps, more than {MOST_PICTURES}: "
            "name a longer --step"
        )
    return [first + i * step for i in range(count)]


def _instant(text: str, project: Project) -> datetime:
    """A clock time on the project's day, local at its place, or a date and time."""
    place = project.where()
    if _CLOCK.fullmatch(text.strip()):
        return parse_instant(f"{_day(project, place)}T{text.strip()}", place)
    return parse_instant(text, place)


def _day(project: Project, place: Place) -> str:
    return project.instant().astimezone(time_zone_at(place)).date().isoformat()


def _step(text: str) -> timedelta:
    match = _STEP.fullmatch(text.strip())
    if match is None:
        raise UserError(f"--step {text} is no length of time: write 30s, 10m or 1h")
    seconds = float(match[1]) * _SECONDS[match[2]]
    if not SHORTEST_STEP_S <= seconds <= 1e9:
        raise UserError(f"--step {text} must be {SHORTEST_STEP_S:g} s or more, 30 years at most")
    return timedelta(seconds=seconds)


def _check_pattern(output: str) -> None:
    """Raise UserError unless the name has one %d, %4d or %04d, of a width that names can have."""
    name = Path(output).name
    found = _NUMBER.findall(name)
    if len(found) != 1 or name.count("%") != 1:
        raise UserError(
            f"{output} is one file, and a span of time makes many: put one %04d in its name, "
            "as day_%04d.png"
        )
    # A width of very many digits is not converted to a number.
    width = found[0].lstrip("0")
    if len(width) > 2 or int(width or 0) > _MOST_DIGITS:
        raise UserError(
            f"{shown('%' + found[0] + 'd')} asks for a number of too many digits: write %04d, or "
            f"{_MOST_DIGITS} digits at most"
        )


def _numbered(output: str, number: int) -> Path:
    """The name with its one %d, %4d or %04d replaced."""
    path = Path(output)
    return path.with_name(_NUMBER.sub(lambda pattern: pattern[0] % number, path.name))


def at_instant(project: Project, instant: datetime) -> Project:
    """The project at this instant."""
    return msgspec.structs.replace(project, at=instant.astimezone(UTC).isoformat())


def other_side(instant: datetime) -> datetime:
    """An instant half a day away, with the sun far from where it was."""
    hours = 12 if instant.year == FIRST_YEAR else -12
    return instant + timedelta(hours=hours)

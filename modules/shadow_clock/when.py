"""`vrut-lite when`: the times of a day at which a shadow falls as it was measured."""

import csv
import io
import json
import re
from datetime import date, timedelta
from pathlib import Path
from typing import Any

import click

from shadow_clock.options import shadow_options
from vrut_lite.arguments import FIRST_YEAR, LAST_YEAR
from vrut_lite.errors import UserError
from vrut_lite.lazy import lazy
from vrut_lite.place_time import Place, local_text, parse_place, time_zone_at
from vrut_lite.write_atomic import atomic_output, check_writable

# Numpy and the ephemeris take a third of a second to import, which --help need not wait for.
_times = lazy("shadow_clock.times")
_measured = lazy("shadow_clock.measured_shadow")

_DATES = re.compile(r"(\d{4}-\d\d-\d\d)(?:\.\.(\d{4}-\d\d-\d\d))?", re.ASCII)
_MOST_DAYS = 3660
_COLUMNS = (
    "date", "instant_utc", "local_time", "earliest_utc", "latest_utc", "bearing_deg",
    "length_ratio", "sun_elevation_deg", "misfit",
)  # fmt: skip


@click.command(name="when")
@shadow_options
@click.option(
    "--place",
    required=True,
    metavar="LAT,LON[,ALT]",
    help="Degrees, north and east positive; altitude in metres.",
)
@click.option(
    "--date",
    "dates",
    required=True,
    metavar="DATE[..DATE]",
    help="A day of the place's clocks, as 2026-06-21, or the first and the last of many.",
)
@click.option("-o", "--output", metavar="FILE", help="Write a table too: .csv or .json.")
def when(
    place: str,
    dates: str,
    output: str | None,
    bearing_deg: float | None,
    length_ratio: float | None,
    bearing_error_deg: float,
    ratio_error: float,
) -> None:
    """Tell when a vertical object on level ground throws the measured shadow.

    Each time has the span that fits the errors: of bearing and ratio, of the penumbra, which is as
    wide as the sun's disc, and of the air's refraction.

    Example: vrut-lite when --shadow-bearing 312 --place 50.0755,14.4378 --date 2026-06-21

    Example: vrut-lite when --length-ratio 1.2 --place 50.0755,14.4378 --date
    2026-06-01..2026-06-30 -o june.csv
    """
    shadow = _measured.MeasuredShadow(bearing_deg, length_ratio, bearing_error_deg, ratio_error)
    where = parse_place(place)
    first, last = _days(dates)
    path = None if output is None else Path(output)
    if path is not None:
        if path.suffix.lower() not in (".csv", ".json"):
            raise UserError(f"cannot write {path}: a table's name ends with .csv or .json")
        check_writable(path)
    days = _times.ShadowDays(first, last, where, time_zone_at(where))
    found = days.times(shadow)
    for one in found:
        click.echo(_line(one, where))
    if not found:
        click.echo(f"none on {dates}: {days.why_none(shadow)}")
    elif last > first:
        seen = {_local_date(one, where) for one in found}
        count = (last - first).days + 1
        click.echo(f"{len(seen)} of {count} days, {len(found)} times")
    if path is not None:
        rows = [_row(one, where) for one in found]
        text = _csv(rows) if path.suffix.lower() == ".csv" else json.dumps(rows, indent=2) + "\n"
        with atomic_output(path) as target:
            target.write_text(text, encoding="utf-8", newline="\n")


def _days(text: str) -> tuple[date, date]:
    match = _DATES.fullmatch(text.strip())
    try:
        if match is None:
            raise ValueError
        first = date.fromisoformat(match[1])
        last = date.fromisoformat(match[2] or match[1])
    except ValueError:
        raise UserError(
            f"--date {text} is no day: write 2026-06-21, or 2026-06-01..2026-06-30"
        ) from None
    if last < first or last - first >= timedelta(days=_MOST_DAYS):
        raise UserError(f"--date {text} must run from an earlier to a later day, ten years at most")
    # A day's samples reach into its neighbours.
    if first.year <= FIRST_YEAR or last.year >= LAST_YEAR:
        raise UserError(
            f"--date {text} lies outside the years {FIRST_YEAR + 1} to {LAST_YEAR - 1}, which the "
            "sun is followed through"
        )
    return first, last


def _line(one: Any, place: Place) -> str:
    """A line for people."""
    zone = time_zone_at(place)
    early, late = (f"{at.astimezone(zone):%H:%M:%S}" for at in (one.earliest, one.latest))
    fit = "" if one.misfit < _times.EXACT else f", misfit {one.misfit:.2f}"
    return (
        f"{local_text(one.instant, place)}, {early} to {late}: shadow to {one.bearing_deg:.1f} "
        f"degrees, {one.length_ratio:.3g} times the height, sun {one.elevation_deg:.1f} degrees "
        f"high{fit}"
    )


def _local_date(one: Any, place: Place) -> date:
    found: date = one.instant.astimezone(time_zone_at(place)).date()
    return found


def _row(one: Any, place: Place) -> dict[str, str | float]:
    zone = time_zone_at(place)
    values = (
        _local_date(one, place).isoformat(),
        one.instant.isoformat(),
        one.instant.astimezone(zone).isoformat(),
        one.earliest.isoformat(),
        one.latest.isoformat(),
        round(one.bearing_deg, 4),
        round(one.length_ratio, 6),
        round(one.elevation_deg, 4),
        round(one.misfit, 4),
    )
    return dict(zip(_COLUMNS, values, strict=True))


def _csv(rows: list[dict[str, str | float]]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, _COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()

"""Reads a year of weather from an EPW file (EnergyPlus Weather), by pvlib."""

import csv
import io
import os
import stat
from datetime import date
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from vrut_lite.checks import refusal_of
from vrut_lite.errors import UserError
from vrut_lite.messages.weather import (
    HOURS,
    LEAP_HOURS,
    MOST_DIFFUSE_W_M2,
    MOST_DIRECT_W_M2,
    SetWeather,
)
from vrut_lite.numeric_types import BoolArray, FloatArray
from vrut_lite.plain_numbers import plain_int
from vrut_lite.sky.suns import hour_edges_s, suns_at
from vrut_lite.text_files import decoded, plain_text
from vrut_lite.weather.weather_checks import contradictions

SUFFIX = ".epw"
# A year by the minute would have 60 times the 1.6 MB of a year by the hour.
_MOST_BYTES = 16_000_000
_MONTH_DAYS = np.array([31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31])
# Older files leave out the last of a row's columns.
_HEAD_LINES, _COLUMNS, _LAST_NEEDED = 8, 35, 24
_MOST_OFFSET_H = 14.0
# Values from which EPW marks a missing measurement.
_MISSING_IRRADIANCE, _MISSING_DEW_POINT, _MISSING_TENTHS = 9999.0, 99.9, 99.0
# 2 cm of water vapour by Perez 1990.
_USUAL_DEW_POINT_C = 11.0


class _Irradiance(NamedTuple):
    """A column of light: its name by pvlib, its title, and what no sun exceeds."""

    name: str
    title: str
    most_w_m2: float


_LIGHT = (
    _Irradiance("dni", "direct normal irradiance", MOST_DIRECT_W_M2),
    _Irradiance("dhi", "diffuse horizontal irradiance", MOST_DIFFUSE_W_M2),
)


def read_weather(path: str | os.PathLike[str]) -> SetWeather:
    """The year of an EPW file.

    Irradiance that is missing while the sun is down is 0. Other missing values are those of the
    same hour of the nearest day, or of the nearest hour; the message's `lacks` says so.

    Raises:
        UserError: pvlib is not installed, or the file is missing, no EPW, or has other than the
            hours of one year.
    """
    file = Path(path)
    return _read(file, _text_of(file))


# Several parts of a command ask for the same year.
@lru_cache(maxsize=2)
def _read(file: Path, text: str) -> SetWeather:
    table, place = _parsed(file, text)
    _check_hours(file, table)
    lacks: list[str] = []
    is_dark = _is_dark(table, place)
    direct, diffuse = (_irradiance(file, table, column, is_dark, lacks) for column in _LIGHT)
    weather = SetWeather(
        path=str(file),
        name=_clean(place.get("city", "")) or file.stem,
        latitude_deg=place["latitude"],
        longitude_deg=place["longitude"],
        altitude_m=place["altitude"],
        utc_offset_h=place["TZ"],
        direct_normal_w_m2=direct,
        diffuse_horizontal_w_m2=diffuse,
        dew_point_c=_dew_point(table, lacks),
        cloud_cover=_cloud_cover(table, lacks),
        lacks=tuple(lacks),
    )
    if refused := refusal_of(weather):
        raise UserError(f"cannot read the weather file {file}: {refused}")
    found = contradictions(weather, _global(table))
    return structs.replace(weather, lacks=(*weather.lacks, *found))


def _text_of(file: Path) -> str:
    try:
        state = file.stat()
        if not stat.S_ISREG(state.st_mode):
            raise UserError(f"cannot open the weather file {file}: it is not a regular file")
        if state.st_size > _MOST_BYTES:
            raise UserError(
                f"the weather file {file} is too large, {state.st_size:,} bytes: a year of hours "
                f"has less than {_MOST_BYTES:,}"
            )
        return decoded(plain_text(file.read_bytes()))
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UserError(f"cannot open the weather file {file}: {reason}") from None


def _parsed(file: Path, text: str) -> tuple[Any, dict[str, Any]]:
    """The rows as pvlib's table, and the place."""
    first, _, rest = text.lstrip().partition("\n")
    # A name in quotation marks may hold commas.
    head = [cell.replace(",", " ") for cell in next(csv.reader([first])) or [""]]
    if head[0].strip().upper() != "LOCATION" or len(head) < 10:
        raise UserError(
            f"{file} is no EPW file: its first line is not LOCATION with latitude, longitude, "
            "time zone and altitude"
        )
    if not _is_place(head[6:10]):
        raise UserError(
            f"cannot read the weather file {file}: latitude, longitude, time zone and altitude of "
            "its first line must be numbers of this earth"
        )
    try:
        from pvlib.iotools import read_epw
    except ImportError:
        raise UserError(
            "weather files need the package pvlib: pip install 'vrut-lite[weather]'"
        ) from None
    whole = _whole_rows(file, [",".join(head), *rest.split("\n")])
    try:
        table, place = read_epw(io.StringIO(whole))
    # pandas raises errors of many kinds.
    except Exception as error:
        reason = " ".join(str(error).split())[:120]
        raise UserError(f"cannot read the weather file {file}: {reason}") from None
    return table, place


def _is_place(cells: list[str]) -> bool:
    """Whether cells are numbers, and the time zone one that pvlib can count with."""
    try:
        numbers = np.array([float(cell) for cell in cells])
    except ValueError:
        return False
    return bool(np.isfinite(numbers).all()) and abs(numbers[2]) <= _MOST_OFFSET_H


def _whole_rows(file: Path, lines: list[str]) -> str:
    """The text with every row filled up to EPW's columns.

    Raises:
        UserError: a row holds no date and hour, or too few columns; the sentence names its line.
    """
    for number, line in enumerate(lines[_HEAD_LINES:], start=_HEAD_LINES):
        cells = line.split(",")
        if not line.strip():
            continue
        if '"' in line or not _LAST_NEEDED <= len(cells) <= _COLUMNS or not _is_hour(cells):
            raise UserError(
                f"the weather file {file}, line {number + 1}: must hold year, month, day, hour "
                f"from 1 to 24, and {_LAST_NEEDED} to {_COLUMNS} columns in all"
            )
        if not _is_date(cells):
            raise UserError(
                f"the weather file {file}, line {number + 1}: the date "
                f"{'-'.join(cell.strip() for cell in cells[:3])} does not exist; mend that row"
            )
        lines[number] = line + "," * (_COLUMNS - len(cells))
    return "\n".join(lines) + "\n"


def _is_hour(cells: list[str]) -> bool:
    """Whether a row begins with four whole numbers, the last one an hour as EPW counts them."""
    try:
        return [plain_int(cell) for cell in cells[:4]][3] in range(1, 25)
    except ValueError:
        return False


def _is_date(cells: list[str]) -> bool:
    """Whether the calendar has the day with which a row begins."""
    try:
        date(*map(int, cells[:3]))
    except (ValueError, OverflowError):
        return False
    return True


def _check_hours(file: Path, table: Any) -> None:
    """Check that the rows are the hours of one year in their order."""
    rows = len(table)
    if rows not in (HOURS, LEAP_HOURS):
        raise UserError(
            f"the weather file {file} has {rows:,} rows: a year by the hour has {HOURS:,}, or "
            f"{LEAP_HOURS:,} with a 29th of February"
        )
    days = _MONTH_DAYS + (np.arange(12) == 1) * (rows == LEAP_HOURS)
    month = np.repeat(np.arange(1, 13), 24 * days)
    day = np.concatenate([np.repeat(np.arange(1, n + 1), 24) for n in days])
    hour = np.tile(np.arange(1, 25), rows // 24)
    found = np.stack([_numbers(table, name) for name in ("month", "day", "hour")])
    wrong = np.flatnonzero((found != np.stack([month, day, hour])).any(axis=0))
    if wrong.size:
        row = wrong[0]
        raise UserError(
            f"the weather file {file} has another hour in row {row + 1} than month {month[row]}, "
            f"day {day[row]}, hour {hour[row]}: hours must be in order, each once"
        )


def _numbers(table: Any, name: str) -> FloatArray:
    """A column; NaN for other texts than numbers."""
    from pandas import to_numeric

    return np.asarray(to_numeric(table[name], errors="coerce"), dtype=float)


def _irradiance(
    file: Path, table: Any, column: _Irradiance, is_dark: BoolArray, lacks: list[str]
) -> tuple[float, ...]:
    values = _numbers(table, column.name)
    known = (values >= 0.0) & (values < _MISSING_IRRADIANCE)
    # More than the sun has above the air is a fault of the instrument.
    known &= values <= column.most_w_m2
    # Instruments rest at night, or show less than nothing.
    light = np.where(known, values, np.where(is_dark, 0.0, np.nan))
    never = np.flatnonzero(np.isnan(light.reshape(-1, 24)).all(axis=0))
    if never.size:
        when = f" in hour {never[0] + 1} of any day, though the sun is up" if known.any() else ""
        raise UserError(f"the weather file {file} has no {column.title}{when}: choose another file")
    return _filled(light, column.title, lacks)


def _is_dark(table: Any, place: dict[str, Any]) -> BoolArray:
    """Whether the sun is down (hours,) in the middle of each hour."""
    middle_s = hour_edges_s(len(table), place["TZ"])[:-1] + 1800.0
    suns = suns_at(middle_s, place["latitude"], place["longitude"], place["altitude"])
    return suns.apparent_elevation_rad < 0.0


def _global(table: Any) -> FloatArray:
    """Global light (hours,) on level ground; NaN where it is missing."""
    values = _numbers(table, "ghi")
    return np.where((values >= 0.0) & (values < _MISSING_IRRADIANCE), values, np.nan)


def _dew_point(table: Any, lacks: list[str]) -> tuple[float, ...]:
    values = _numbers(table, "temp_dew")
    known = (values > -_MISSING_DEW_POINT) & (values < 60.0)
    if not known.any():
        lacks.append(f"no dew point: {_USUAL_DEW_POINT_C:g} degrees Celsius stands in")
        return (_USUAL_DEW_POINT_C,) * len(values)
    return _filled(np.where(known, values, np.nan), "the dew point", lacks)


def _cloud_cover(table: Any, lacks: list[str]) -> tuple[float, ...]:
    for name in ("total_sky_cover", "opaque_sky_cover"):
        values = _numbers(table, name)
        known = (values >= 0.0) & (values <= 10.0)
        if known.any():
            return _filled(np.where(known, 0.1 * values, np.nan), "cloud cover", lacks)
    lacks.append("no cloud cover: the time bar shows no clouds")
    return ()


def _filled(values: FloatArray, title: str, lacks: list[str]) -> tuple[float, ...]:
    """A year without NaN: by the same hour of the nearest day, or an hour that is never known by
    the nearest one."""
    by_day = values.reshape(-1, 24)
    unknown = np.isnan(by_day)
    never = unknown.all(axis=0)
    days, hours = np.arange(len(by_day)), np.arange(24)
    for hour in np.flatnonzero(unknown.any(axis=0) & ~never):
        have = days[~unknown[:, hour]]
        by_day[:, hour] = by_day[_nearest(days, have), hour]
    by_day[:, never] = by_day[:, _nearest(hours, hours[~never])[never]]
    count, of_day = int(unknown[:, ~never].sum()), int(never.sum())
    if count:
        found = "1 hour lacks" if count == 1 else f"{count:,} hours lack"
        lacks.append(f"{found} {title}: the same hour of the nearest day stands in")
    if of_day:
        found = "1 hour of each day lacks" if of_day == 1 else f"{of_day} hours of each day lack"
        lacks.append(f"{found} {title}: the nearest hour stands in")
    return tuple(by_day.ravel().tolist())


def _nearest(places: NDArray[np.integer], have: NDArray[np.integer]) -> NDArray[np.integer]:
    """The nearest of rising numbers (H,) to each of some places (N,), the earlier of two."""
    after = np.clip(np.searchsorted(have, places), 0, have.size - 1)
    before = np.clip(after - 1, 0, None)
    nearer = np.abs(have[before] - places) <= np.abs(have[after] - places)
    return np.where(nearer, have[before], have[after])


def _clean(name: object) -> str:
    return "".join(letter for letter in str(name).strip() if letter.isprintable())[:80]

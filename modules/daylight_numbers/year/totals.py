"""Sums of a year over months or a range of days: doses of light, and radiation of all wavelengths.

Radiation follows from the weather file: each hour's sky and sun are scaled so that they bring the
file's diffuse and direct irradiance in place of their illuminance. Surfaces and glass have the same
reflectance and transmittance for all wavelengths as for light.
"""

import csv
import itertools
import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import date
from pathlib import Path
from typing import NamedTuple

import numpy as np

from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.report import Table
from daylight_numbers.year.year import LUMENS_RGB, Year
from daylight_numbers.year.year_light import HOURS, YEAR, YearLight
from vrut_lite.errors import UserError
from vrut_lite.messages.weather import LEAP_HOURS, SetWeather
from vrut_lite.numeric_types import Float32Array, FloatArray, IntArray
from vrut_lite.write_atomic import atomic_output

_RANGE = re.compile(r"(\d\d-\d\d)\.\.(\d\d-\d\d)", re.ASCII)
# Illuminance (lx) below which an hour's light has no radiation.
_LEAST_LX = 1.0


class Period(NamedTuple):
    """Days of a year: a name, the first hour, and the hour after the last."""

    name: str
    first: int
    end: int


class Totals(NamedTuple):
    """Sums of sensors (P) over periods (K): dose of all light and of the sun straight, klx h, and
    radiation, kWh m^-2, None without a year of weather."""

    dose_klxh: FloatArray
    sun_klxh: FloatArray
    radiation_kwh_m2: FloatArray | None


def parse_totals(text: str) -> tuple[Period, ...]:
    """The periods of `month`, all twelve, or of a range MM-DD..MM-DD.

    Raises:
        UserError: the text is neither, or the range runs backwards.
    """
    if text == "month":
        starts = [date(YEAR, month, 1) for month in range(1, 13)] + [date(YEAR + 1, 1, 1)]
        return tuple(
            Period(f"{first:%B}", _hour_of(first), _hour_of(after))
            for first, after in itertools.pairwise(starts)
        )
    match = _RANGE.fullmatch(text)
    try:
        if match is None:
            raise ValueError
        first, last = (date.fromisoformat(f"{YEAR}-{part}") for part in match.groups())
    except ValueError:
        raise UserError(
            f"--totals {text} is neither month nor a range of days such as 04-01..09-30"
        ) from None
    if last < first:
        raise UserError(f"--totals {text} runs from an earlier to a later day of a year")
    name = f"{first:%-d %B} to {last:%-d %B}"
    return (Period(name, _hour_of(first), _hour_of(last) + HOURS),)


def radiant_light(light: YearLight, weather: SetWeather) -> YearLight:
    """The same hours, scaled so that illuminances in lx become irradiances in W m^-2 of all
    wavelengths, by the weather file's direct and diffuse ones."""
    row = light.hour
    if len(weather.direct_normal_w_m2) == LEAP_HOURS:
        row = row + HOURS * (row >= _hour_of(date(YEAR, 3, 1)))
    direct = np.array(weather.direct_normal_w_m2)[row]
    diffuse = np.array(weather.diffuse_horizontal_w_m2)[row]
    of_sun = _ratio(direct, light.sun_irradiance_rgb @ LUMENS_RGB)
    of_sky = _ratio(diffuse, light.diffuse_lux)
    return replace(
        light,
        sky=light.sky * of_sky[:, None, None].astype(np.float32),
        sun_irradiance_rgb=light.sun_irradiance_rgb * of_sun[:, None],
    )


def totals_of(
    year: Year, radiant: Year | None, hours: IntArray, periods: Sequence[Period]
) -> Totals:
    """Sums of a year's illuminances, and of its irradiances by `radiant_light`."""
    energy = None if radiant is None else sums(radiant.total, hours, periods) / 1000.0
    dose, sun = (sums(values, hours, periods) / 1000.0 for values in (year.total, year.sun))
    return Totals(dose, sun, energy)


def sums(values: Float32Array, hours: IntArray, periods: Sequence[Period]) -> FloatArray:
    """Sums (P, K) of values (P, H) of hours of the year (H,) over periods."""
    parts = [
        values[:, (hours >= one.first) & (hours < one.end)].sum(axis=1, dtype=float)
        for one in periods
    ]
    return np.stack(parts, axis=1)


def totals_table(sensors: Sensors, totals: Totals, periods: Sequence[Period]) -> Table:
    """Means over planes, a plane and a period a row."""
    rows = []
    for plane, name in enumerate(sensors.names):
        here = sensors.plane == plane
        for n, period in enumerate(periods):
            row = [f"{name}, {period.name}", f"{totals.dose_klxh[here, n].mean():,.0f}"]
            row.append(f"{totals.sun_klxh[here, n].mean():,.0f}")
            if totals.radiation_kwh_m2 is not None:
                row.append(f"{totals.radiation_kwh_m2[here, n].mean():,.1f}")
            rows.append(row)
    columns = ["plane", "dose klx h", "of direct sun klx h", "radiation kWh/m²"]
    return Table("Totals", columns[: len(rows[0])], rows)


def write_totals(path: Path, sensors: Sensors, totals: Totals, periods: Sequence[Period]) -> None:
    """Write a row for each sensor and period.

    Raises:
        UserError: the file cannot be written.
    """
    with atomic_output(path) as beside, beside.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        energy = totals.radiation_kwh_m2
        writer.writerow(
            ["plane", "x_m", "y_m", "z_m", "period", "dose_klxh", "of_sun_klxh"]
            + ["radiation_kwh_m2"] * (energy is not None)
        )
        for point, (place, plane) in enumerate(zip(sensors.places_m, sensors.plane, strict=True)):
            for n, period in enumerate(periods):
                values = [totals.dose_klxh[point, n], totals.sun_klxh[point, n]]
                values += [] if energy is None else [energy[point, n]]
                writer.writerow(
                    [
                        sensors.names[plane],
                        *(f"{value:.6g}" for value in place),
                        period.name,
                        *(f"{value:.6g}" for value in values),
                    ]
                )


def _hour_of(day: date) -> int:
    return HOURS * (day - date(YEAR, 1, 1)).days


def _ratio(irradiance: FloatArray, lux: FloatArray) -> FloatArray:
    return np.where(lux > _LEAST_LX, irradiance / np.maximum(lux, _LEAST_LX), 0.0)

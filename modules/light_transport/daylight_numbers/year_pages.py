"""A year's columns, tables and pictures for the command's folder."""

from collections.abc import Callable, Iterable
from datetime import UTC, date, datetime, time, timedelta
from pathlib import Path
from typing import NamedTuple

import numpy as np

from light_transport.daylight_numbers.annual import Year, solved_year, year_matrices, year_of
from light_transport.daylight_numbers.blinds import shaded_year
from light_transport.daylight_numbers.eyes import Eyes, glare_table
from light_transport.daylight_numbers.heat_map import heat_map
from light_transport.daylight_numbers.metrics import by_day_and_hour, point_year
from light_transport.daylight_numbers.opened_scene import OpenedScene
from light_transport.daylight_numbers.openings import room_of
from light_transport.daylight_numbers.plan_picture import Quantity, plan_picture
from light_transport.daylight_numbers.report import Table
from light_transport.daylight_numbers.sensors import Sensors
from light_transport.daylight_numbers.sun_hours import sun_hours, sun_in_openings, suns_of_day
from light_transport.daylight_numbers.work import Work
from light_transport.daylight_numbers.year_light import YearLight, lit_hours, year_light
from light_transport.daylight_numbers.year_tables import (
    method,
    row_of_plane,
    udi_table,
    with_blinds,
    year_table,
)
from vrut_lite.headless import write_png
from vrut_lite.numeric_types import FloatArray

Numbers = dict[str, FloatArray]
_PLANS = {
    "da_300_percent": Quantity("time above 300 lx, 8:00 to 18:00", "%"),
    "da_300_with_blinds_percent": Quantity("time above 300 lx with blinds", "%"),
    "dose_klxh": Quantity("dose of a year", "klx h"),
}
_MOST_HEAT_MAPS = 4


class YearAsked(NamedTuple):
    """What is computed: `blinds` is what these let through when closed; `sun_day`, of YEAR, that of
    EN 17037's hours of sun."""

    blinds: float
    eyes: Eyes | None
    sun_day: date


class YearPages(NamedTuple):
    """What a year adds to tables and page."""

    columns: Numbers
    tables: list[Table]
    pictures: dict[Path, str]
    method: list[str]


def year_pages(
    folder: Path,
    work: Work,
    opened: OpenedScene,
    asked: YearAsked,
    tracked: Callable[[Iterable[int], int], Iterable[int]],
) -> YearPages:
    """Compute a year under the present sky's module.

    Raises:
        UserError: the sky has no light for an hour, or a picture cannot be written.
    """
    sensors, offset_h = work.sensors, opened.standard_offset_h
    hours = lit_hours(opened.place, offset_h)
    light = year_light(opened, hours, offset_h, tracked(range(len(hours)), len(hours)))
    solved = solved_year(work.bake, light)
    year = year_of(year_matrices(work, light, solved), light)
    planes = range(len(sensors.names))
    rooms = {plane: room for plane in planes if (room := room_of(work, plane)) is not None}
    shaded = {
        plane: shaded_year(work, plane, room, year, light, solved, asked.blinds)
        for plane, room in rooms.items()
    }
    points = point_year(year.total, year, light)
    halves = [point_year(half, year, light) for half in year.halves]
    midnight = datetime.combine(asked.sun_day, time(), UTC) - timedelta(hours=offset_h)
    suns = suns_of_day(opened, midnight)
    sun = sun_hours(work, sensors, suns)
    rows = []
    for plane in planes:
        room = rooms.get(plane)
        best = sun_in_openings(work, room, suns) if room else sun[sensors.plane == plane].max()
        rows.append(
            row_of_plane(
                sensors, plane, points, halves, shaded.get(plane), room, float(best), light
            )
        )
    columns = {
        "da_300_percent": 100.0 * points.da_300,
        "da_300_error_percent": 50.0 * np.abs(halves[0].da_300 - halves[1].da_300),
        "da_300_with_blinds_percent": 100.0 * with_blinds(shaded, light, len(sensors)),
        "direct_sun_above_1000_lx_h": points.ase_h,
        "udi_below_100_percent": 100.0 * points.udi[:, 0],
        "udi_100_300_percent": 100.0 * points.udi[:, 1],
        "udi_300_3000_percent": 100.0 * points.udi[:, 2],
        "udi_above_3000_percent": 100.0 * points.udi[:, 3],
        "half_of_daylight_hours_lx": points.en_lx,
        "dose_klxh": points.dose_klxh,
        "sun_of_en_17037_h": sun,
    }
    glare = [] if asked.eyes is None else [glare_table(asked.eyes, light, solved)]
    return YearPages(
        columns,
        [year_table(rows, f"{asked.sun_day:%-d %B}"), udi_table(sensors, points), *glare],
        _pictures(folder, sensors, columns, year, light),
        method(light.source, len(hours), asked.blinds),
    )


def _pictures(
    folder: Path, sensors: Sensors, columns: Numbers, year: Year, light: YearLight
) -> dict[Path, str]:
    """Plans and heat maps, written, with their captions."""
    pictures: dict[Path, str] = {}
    for name, quantity in _PLANS.items():
        if np.any(sensors.cell >= 0) and np.isfinite(columns[name]).any():
            path = folder / f"{name}.png"
            write_png(path, plan_picture(sensors, columns[name], quantity))
            pictures[path] = f"{quantity.title.capitalize()} ({quantity.unit})"
    for plane, name in list(enumerate(sensors.names))[:_MOST_HEAT_MAPS]:
        mean = year.total[sensors.plane == plane].mean(axis=0)
        path = folder / f"hours_{plane + 1}.png"
        title = f"{name}: mean illuminance, standard time"
        field = by_day_and_hour(mean.astype(float), light.hour)
        write_png(path, heat_map(field, title, Quantity("illuminance", "lx")))
        pictures[path] = f"Mean illuminance of {name}, hour by hour of the year"
    return pictures

"""A year's columns, tables and pictures for the command's folder."""

from collections.abc import Callable, Iterable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import NamedTuple

import numpy as np

from light_transport.daylight_numbers.annual import (
    DAYS_BETWEEN,
    solved_year,
    year_matrices,
    year_of,
)
from light_transport.daylight_numbers.blinds import Shaded, shaded_year
from light_transport.daylight_numbers.eyes import Eyes, year_table
from light_transport.daylight_numbers.heat_map import heat_map
from light_transport.daylight_numbers.metrics import (
    PointYear,
    RoomYear,
    by_day_and_hour,
    daylight_autonomy,
    point_year,
    room_year,
    spatial_autonomy,
)
from light_transport.daylight_numbers.opened_scene import OpenedScene
from light_transport.daylight_numbers.plan_picture import Quantity, plan_picture
from light_transport.daylight_numbers.report import Table
from light_transport.daylight_numbers.sensors import Sensors
from light_transport.daylight_numbers.sun_hours import sun_hours
from light_transport.daylight_numbers.work import Work
from light_transport.daylight_numbers.year_light import (
    YearLight,
    lit_hours,
    standard_offset_h,
    year_light,
)
from vrut_lite.numeric_types import FloatArray
from vrut_lite.pictures.image_files import write_png

Numbers = dict[str, FloatArray]
# EN 17037: hours of sun of one day between 1 February and 21 March, in the best place of a room.
_SUN_LEVELS = ((4.0, "high"), (3.0, "medium"), (1.5, "minimum"))
_PLANS = {
    "da_300_percent": Quantity("time above 300 lx, 8:00 to 18:00", "%"),
    "dose_klxh": Quantity("dose of a year", "klx h"),
}
_MOST_HEAT_MAPS = 4


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
    blinds: float,
    eyes: Eyes | None,
    tracked: Callable[[Iterable[int], int], Iterable[int]],
) -> YearPages:
    """Compute a year under the present sky's module; `blinds` is their transmittance when closed.

    Raises:
        UserError: the sky has no light for an hour, or a picture cannot be written.
    """
    offset_h = standard_offset_h(opened.place.longitude_deg)
    hours = lit_hours(opened.place, offset_h)
    light = year_light(opened, hours, offset_h, tracked(range(len(hours)), len(hours)))
    solved = solved_year(work.bake, light)
    year = year_of(year_matrices(work, light, solved), light)
    shaded = {
        plane: found
        for plane in range(len(work.sensors.names))
        if (found := shaded_year(work, plane, year, light, solved, blinds)) is not None
    }
    points = point_year(year.total, year, light)
    halves = [point_year(half, year, light) for half in year.halves]
    march = datetime(2025, 3, 21, tzinfo=UTC) - timedelta(hours=offset_h)
    sun = sun_hours(work, opened, march)
    columns = {
        "da_300_percent": 100.0 * points.da_300,
        "da_300_error_percent": 50.0 * np.abs(halves[0].da_300 - halves[1].da_300),
        "da_300_with_blinds_percent": 100.0 * _with_blinds(shaded, light, len(work.sensors)),
        "direct_sun_above_1000_lx_h": points.ase_h,
        "udi_below_100_percent": 100.0 * points.udi[:, 0],
        "udi_100_300_percent": 100.0 * points.udi[:, 1],
        "udi_300_3000_percent": 100.0 * points.udi[:, 2],
        "udi_above_3000_percent": 100.0 * points.udi[:, 3],
        "half_of_daylight_hours_lx": points.en_lx,
        "dose_klxh": points.dose_klxh,
        "sun_21_march_h": sun,
    }
    pictures: dict[Path, str] = {}
    if np.any(work.sensors.cell >= 0):
        for name, quantity in _PLANS.items():
            path = folder / f"{name}.png"
            write_png(path, plan_picture(work.sensors, columns[name], quantity))
            pictures[path] = f"{quantity.title.capitalize()} ({quantity.unit})"
    for plane, name in list(enumerate(work.sensors.names))[:_MOST_HEAT_MAPS]:
        mean = year.total[work.sensors.plane == plane].mean(axis=0)
        path = folder / f"hours_{plane + 1}.png"
        title = f"{name}: mean illuminance, standard time"
        field = by_day_and_hour(mean.astype(float), light.hour)
        write_png(path, heat_map(field, title, Quantity("illuminance", "lx")))
        pictures[path] = f"Mean illuminance of {name}, hour by hour of the year"
    return YearPages(
        columns,
        [
            _table(work.sensors, points, halves, _shaded_cells(shaded, light), sun),
            _udi_table(work.sensors, points),
            *([] if eyes is None else [year_table(eyes, light, solved)]),
        ],
        pictures,
        _method(light.source, len(hours), blinds),
    )


def _with_blinds(shaded: dict[int, Shaded], light: YearLight, count: int) -> FloatArray:
    """Share (P,) of hours with 300 lx under blinds; nan where there are none."""
    found = np.full(count, np.nan)
    for one in shaded.values():
        found[one.sensors] = daylight_autonomy(one.total, light)
    return found


def _shaded_cells(shaded: dict[int, Shaded], light: YearLight) -> dict[int, str]:
    """What stands in a plane's cell: sDA, its error, and how long blinds are closed."""
    cells = {}
    for plane, one in shaded.items():
        share, first, second = (
            spatial_autonomy(daylight_autonomy(total, light)) for total in (one.total, *one.halves)
        )
        hours = ", ".join(f"{side} {count:,} h" for side, count in one.closed_h.items())
        cells[plane] = f"{share:.1%} ± {_half(first, second):.1%} (closed: {hours})"
    return cells


def _table(
    sensors: Sensors,
    points: PointYear,
    halves: list[PointYear],
    shaded: dict[int, str],
    sun: FloatArray,
) -> Table:
    rows = []
    for plane, name in enumerate(sensors.names):
        room = room_year(points, sensors, plane)
        one, other = (room_year(half, sensors, plane) for half in halves)
        best = float(sun[sensors.plane == plane].max())
        level = next((said for least, said in _SUN_LEVELS if best >= least), "none")
        rows.append(
            [
                name,
                shaded.get(plane, "no room"),
                f"{room.da_300_50:.1%} ± {_half(one.da_300_50, other.da_300_50):.1%}",
                f"{room.ase_1000_250:.1%}",
                f"{room.en_level} ({room.en_median_lx:,.0f} lx, {room.en_low_lx:,.0f} lx)",
                f"{level} ({best:.1f} h)",
                f"{room.dose_klxh:,.0f} ± {_half(one.dose_klxh, other.dose_klxh):,.0f}",
            ]
        )
    columns = [
        "plane", "sDA 300/50", "DA 300/50, unshaded", "ASE 1000/250",
        "EN 17037 daylight (on 50 %, on 95 %)",
        "EN 17037 sun on 21 March, best place", "dose klx h",
    ]  # fmt: skip
    return Table("The year", columns, rows)


def _udi_table(sensors: Sensors, points: PointYear) -> Table:
    rooms: list[RoomYear] = [room_year(points, sensors, n) for n in range(len(sensors.names))]
    rows = [
        [name, *(f"{share:.1%}" for share in room.udi)]
        for name, room in zip(sensors.names, rooms, strict=True)
    ]
    columns = ["plane", "below 100 lx", "100 to 300 lx", "300 to 3000 lx", "above 3000 lx"]
    return Table("Useful daylight illuminance, share of 8:00 to 18:00", columns, rows)


def _half(one: float, other: float) -> float:
    return 0.5 * abs(one - other)


def _method(source: str, hours: int, blinds: float) -> list[str]:
    return [
        f"The year has {hours:,} hours with light, each by its middle in standard time; sky and "
        f"sun by {source}.",
        "sDA 300/50 (IES LM-83): share of the plane that has 300 lx in half of the 3,650 hours "
        "from 8:00 to 18:00. Each side of a room has blinds, closed in hours in which more than "
        "2 % of its sensors get 1,000 lx of direct sun through that side; closed, they let "
        f"{blinds:.0%} through, evenly. 'Unshaded' is the same without blinds. ASE 1000/250: share "
        "with more than 1,000 lx of direct sun alone in more than 250 of these hours.",
        "EN 17037: illuminance on 50 % and on 95 % of the plane, 0.5 m from walls, in half of the "
        "4,380 hours with most light outdoors, as for openings in walls; minimum, medium, high are "
        "300/100, 500/300, 750/500 lx. The view out is left out.",
        f"Bounces of sunlit surfaces are solved every {DAYS_BETWEEN} days and interpolated; the "
        "sun's own light is a ray for each sensor and hour.",
    ]

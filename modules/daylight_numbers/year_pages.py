"""A year's columns, tables, pictures and method for the command's folder."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import UTC, date, datetime, time, timedelta
from pathlib import Path
from typing import NamedTuple

import numpy as np

from daylight_numbers.glare.eyes import Eyes, glare_table
from daylight_numbers.glare.glare import glare_year
from daylight_numbers.lamps.lamp_pages import LampPages
from daylight_numbers.lamps.lighting import Lighting
from daylight_numbers.lamps.lighting_pages import lighting_pages
from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.moving_blinds import (
    StateLight,
    moves,
    moving_glare,
    moving_year,
    pane_states,
    states_by_glare,
    states_table,
)
from daylight_numbers.moving_blinds import method as moving_method
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.pictures import PictureQuantity, heat_map, plan_picture
from daylight_numbers.report import Table
from daylight_numbers.rooms import DaylitRoom
from daylight_numbers.standards.standards import WELL_EN_LX, PlaneYear, YearFound
from daylight_numbers.standards.sun_hours import sun_hours, sun_in_openings, sun_level, suns_of_day
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.blinds import Shaded, shaded_year
from daylight_numbers.year.metrics import (
    PointYear,
    RoomYear,
    by_day_and_hour,
    daylight_autonomy,
    median_diffuse_lx,
    point_year,
    room_year,
    spatial_autonomy,
)
from daylight_numbers.year.totals import (
    Period,
    radiant_light,
    totals_of,
    totals_table,
    write_totals,
)
from daylight_numbers.year.year import (
    DAYS_BETWEEN,
    SolvedYear,
    Year,
    solved_year,
    year_matrices,
    year_of,
)
from daylight_numbers.year.year_light import YearLight, lit_hours, year_light
from vrut_lite.headless import write_png
from vrut_lite.messages.glazing import GlazingFile
from vrut_lite.messages.weather import SetWeather
from vrut_lite.numeric_types import FloatArray
from vrut_lite.quantities import percent_text

Numbers = dict[str, FloatArray]
_PLANS = {
    "da_300_percent": PictureQuantity("time above 300 lx, 8:00 to 18:00", "%", from_zero=True),
    "da_300_with_blinds_percent": PictureQuantity(
        "time above 300 lx with blinds", "%", from_zero=True
    ),
    "dose_klxh": PictureQuantity("dose of a year", "klx h"),
}
_MOST_HEAT_MAPS = 4


class YearRequest(NamedTuple):
    """A request: `rooms` by the number of their work plane; `blinds` is the transmittance of closed
    blinds; `sun_day`, of YEAR, the day of EN 17037's hours of sun; `bsdf` has blinds that move, and
    `work_in` makes the scene ready with states of them; `periods` are those of totals; `lighting`
    the lamps, if any."""

    rooms: Mapping[int, DaylitRoom]
    blinds: float
    eyes: Eyes | None
    sun_day: date
    bsdf: Mapping[str, GlazingFile]
    work_in: Callable[[Mapping[str, int]], tuple[DaylightWork, Eyes | None]]
    periods: Sequence[Period]
    lighting: Lighting | None


class YearPages(NamedTuple):
    """A year's part of tables and page, its numbers for standards, and what these are made of."""

    found: YearFound
    light: YearLight
    solved: SolvedYear
    year: Year
    columns: Numbers
    tables: list[Table]
    pictures: dict[Path, str]
    method: list[str]


def year_pages(
    folder: Path,
    work: DaylightWork,
    opened: OpenedScene,
    asked: YearRequest,
    tracked: Callable[[Iterable[int], int], Iterable[int]],
) -> YearPages:
    """Compute a year under the present sky's module.

    Raises:
        UserError: the sky has no light for an hour, or a picture cannot be written.
    """
    sensors, offset_h = work.sensors, opened.standard_offset_h
    hours = lit_hours(opened.place, offset_h)
    light = year_light(opened, hours, offset_h, tracked)
    solved = solved_year(work.transport, light, bounces=work.operator.bounces)
    of_states: list[Table] = []
    if moves(asked.bsdf):
        assert work.operator.panes is not None
        states = pane_states(work.operator.panes, asked.bsdf, light)
        known: dict[tuple[int, ...], StateLight] = {}

        def light_in(chosen: Mapping[str, int]) -> StateLight:
            key = tuple(chosen[name] for name in sorted(chosen))
            if key not in known and not any(key):
                known[key] = StateLight(work, solved, light.hour, asked.eyes)
            elif key not in known:
                other, eyes = asked.work_in(chosen)
                bounces = other.operator.bounces
                again = solved_year(other.transport, light, bounces=bounces)
                known[key] = StateLight(other, again, light.hour, eyes)
            return known[key]

        states = states_by_glare(states, asked.bsdf, light, light_in)
        of_states = [states_table(states, asked.bsdf, light)]

        def year_under(lit: YearLight) -> Year:
            return moving_year(states, lit, light_in)

        dgp = None if asked.eyes is None else moving_glare(states, light, light_in)
    else:

        def year_under(lit: YearLight) -> Year:
            return year_of(year_matrices(work, lit, solved), lit)

        dgp = None if asked.eyes is None else glare_year(*asked.eyes, light, solved)
    year = year_under(light)
    planes, rooms = range(len(sensors.names)), asked.rooms
    shaded = {
        plane: shaded_year(work, plane, room, year, light, solved, asked.blinds)
        for plane, room in rooms.items()
    }
    points = point_year(year.total, year, light)
    halves = [point_year(half, year, light) for half in year.halves]
    midnight = datetime.combine(asked.sun_day, time(), UTC) - timedelta(hours=offset_h)
    suns = suns_of_day(opened.place, midnight)
    sun = sun_hours(work, sensors, suns)
    rows, of_planes = [], {}
    for plane in planes:
        room, blinds = rooms.get(plane), shaded.get(plane)
        best = sun_in_openings(work, room, suns) if room else sun[sensors.plane == plane].max()
        rows.append(row_of_plane(sensors, plane, points, halves, blinds, room, float(best), light))
        of_planes[plane] = PlaneYear(
            room_year(points, sensors, plane, room is not None and room.is_lit_by_roof),
            None if blinds is None else spatial_autonomy(daylight_autonomy(blinds.total, light)),
            None if blinds is None else _sda_200_40(blinds, light),
            [float(np.mean(points.en_lx[sensors.plane == plane] >= lux)) for lux in WELL_EN_LX],
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
    totals: list[Table] = []
    if asked.periods:
        weather = opened.kernel.last(SetWeather)
        is_file = weather is not None and bool(weather.path)
        radiant = year_under(radiant_light(light, weather)) if weather and is_file else None
        found = totals_of(year, radiant, light.hour, asked.periods)
        write_totals(folder / "totals.csv", sensors, found, asked.periods)
        totals.append(totals_table(sensors, found, asked.periods))
    glare = [] if dgp is None else [glare_table(dgp, light)]
    lamps = LampPages({}, [], {}, [])
    if asked.lighting is not None:
        daylight = year.total.copy()
        for one in shaded.values():
            daylight[one.sensors] = one.total
        lamps = lighting_pages(folder, work, asked.lighting, daylight, light, solved)
    return YearPages(
        YearFound(
            of_planes,
            [row[1] for table in glare for row in table.rows],
            median_diffuse_lx(light),
        ),
        light,
        solved,
        year,
        columns | lamps.columns,
        [
            year_table(rows, f"{asked.sun_day:%-d %B}"),
            udi_table(sensors, points),
            *of_states,
            *totals,
            *glare,
            *lamps.tables,
        ],
        _pictures(folder, sensors, columns, year, light) | lamps.pictures,
        [
            *method(light.source, len(hours), asked.blinds),
            *moving_method(asked.bsdf),
            *lamps.method,
        ],
    )


def _sda_200_40(blinds: Shaded, light: YearLight) -> float:
    """SDA 200/40 of WELL v2's L01, with blinds."""
    return spatial_autonomy(daylight_autonomy(blinds.total, light, 200.0), 0.4)


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
        write_png(path, heat_map(field, title, PictureQuantity("illuminance", "lx")))
        pictures[path] = f"Mean illuminance of {name}, hour by hour of the year"
    return pictures


def with_blinds(shaded: dict[int, Shaded], light: YearLight, count: int) -> FloatArray:
    """Share (P,) of hours with 300 lx under blinds; nan where a sensor has no blinds."""
    found = np.full(count, np.nan)
    for one in shaded.values():
        found[one.sensors] = daylight_autonomy(one.total, light)
    return found


def row_of_plane(
    sensors: Sensors,
    plane: int,
    points: PointYear,
    halves: list[PointYear],
    shaded: Shaded | None,
    room: DaylitRoom | None,
    best_sun_h: float,
    light: YearLight,
) -> list[str]:
    """Cells of a work plane; `points` by all rays, `halves` by either half."""
    by_roof = room is not None and room.is_lit_by_roof
    all_rays, one, other = (room_year(each, sensors, plane, by_roof) for each in (points, *halves))
    level = sun_level(best_sun_h)
    targets = f"{all_rays.en_median_lx:,.0f} lx, {all_rays.en_low_lx:,.0f} lx"
    return [
        sensors.names[plane],
        *(("no room", "") if shaded is None else _sda(shaded, light)),
        _within(all_rays.da_300_50, _half(one.da_300_50, other.da_300_50)),
        percent_text(all_rays.ase_1000_250, 1),
        f"{all_rays.en_level} ({targets}{', roof lights' if by_roof else ''})",
        f"{level} ({best_sun_h:.1f} h)",
        f"{all_rays.dose_klxh:,.0f} ± {_half(one.dose_klxh, other.dose_klxh):,.0f}",
    ]


def _sda(shaded: Shaded, light: YearLight) -> tuple[str, str]:
    share, first, second = (
        spatial_autonomy(daylight_autonomy(total, light))
        for total in (shaded.total, *shaded.halves)
    )
    hours = ", ".join(f"{side} {count:,} h" for side, count in shaded.closed_h.items())
    return _within(share, _half(first, second)), hours or "by measured panes"


def year_table(rows: list[list[str]], sun_day: str) -> Table:
    """The year, a plane a row."""
    columns = [
        "plane", "sDA 300/50", "blinds closed", "DA 300/50, unshaded", "ASE 1000/250",
        "EN 17037 daylight (on 50 %, on 95 %)", f"EN 17037 sun on {sun_day}", "dose klx h",
    ]  # fmt: skip
    return Table("The year", columns, rows)


def udi_table(sensors: Sensors, points: PointYear) -> Table:
    """Useful daylight illuminance, a plane a row."""
    rooms: list[RoomYear] = [room_year(points, sensors, n) for n in range(len(sensors.names))]
    rows = [
        [name, *(percent_text(share, 1) for share in room.udi)]
        for name, room in zip(sensors.names, rooms, strict=True)
    ]
    columns = ["plane", "below 100 lx", "100 to 300 lx", "300 to 3,000 lx", "above 3,000 lx"]
    return Table("Useful daylight illuminance, share of 8:00 to 18:00", columns, rows)


def _within(share: float, error: float) -> str:
    return f"{percent_text(share, 1)} ± {percent_text(error, 1)}"


def _half(one: float, other: float) -> float:
    return 0.5 * abs(one - other)


def method(source: str, hours: int, blinds: float) -> list[str]:
    """Sentences on how a year is computed."""
    return [
        f"The year has {hours:,} hours with light, each by its middle in standard time; sky and "
        f"sun by {source}.",
        "sDA 300/50 (IES LM-83): share of the plane that has 300 lx in half of the 3,650 hours "
        "from 8:00 to 18:00. Each side of a room has blinds, closed in hours in which more than "
        "2 % of its sensors get 1,000 lx of direct sun through that side; closed, they let "
        f"{percent_text(blinds)} through, evenly; none hang where panes are measured. 'Unshaded' "
        "is the same without blinds. ASE "
        "1000/250: share with more than 1,000 lx of direct sun alone in more than 250 of these "
        "hours.",
        "EN 17037: illuminance on 50 % and on 95 % of the plane, 0.5 m from walls, in half of the "
        "4,380 hours with most light outdoors; minimum, medium, high are 300/100, 500/300, 750/500 "
        "lx, and 300, 500, 750 lx on 95 % where most openings are in the roof. Hours of sun are "
        "the best place's in a room's openings, 1.2 m above the floor.",
        f"Bounces of sunlit surfaces are solved every {DAYS_BETWEEN} days and interpolated; the "
        "sun's own light is a ray for each sensor and hour.",
    ]

"""A year's tables and what is said of its method."""

import numpy as np

from light_transport.daylight_numbers.annual import DAYS_BETWEEN
from light_transport.daylight_numbers.blinds import Shaded
from light_transport.daylight_numbers.metrics import (
    PointYear,
    RoomYear,
    daylight_autonomy,
    room_year,
    spatial_autonomy,
)
from light_transport.daylight_numbers.openings import Room
from light_transport.daylight_numbers.report import Table
from light_transport.daylight_numbers.sensors import Sensors
from light_transport.daylight_numbers.year_light import YearLight
from vrut_lite.numeric_types import FloatArray

# EN 17037: hours of sun of one day between 1 February and 21 March.
_SUN_LEVELS = ((4.0, "high"), (3.0, "medium"), (1.5, "minimum"))


def with_blinds(shaded: dict[int, Shaded], light: YearLight, count: int) -> FloatArray:
    """Share (P,) of hours with 300 lx under blinds; nan where there are none."""
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
    room: Room | None,
    best_sun_h: float,
    light: YearLight,
) -> list[str]:
    """Cells of a work plane; `points` by all rays, `halves` by either half."""
    by_roof = room is not None and room.is_lit_by_roof
    all_rays, one, other = (room_year(each, sensors, plane, by_roof) for each in (points, *halves))
    level = next((said for least, said in _SUN_LEVELS if best_sun_h >= least), "none")
    targets = f"{all_rays.en_median_lx:,.0f} lx, {all_rays.en_low_lx:,.0f} lx"
    return [
        sensors.names[plane],
        *(("no room", "") if shaded is None else _sda(shaded, light)),
        f"{all_rays.da_300_50:.1%} ± {_half(one.da_300_50, other.da_300_50):.1%}",
        f"{all_rays.ase_1000_250:.1%}",
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
    return f"{share:.1%} ± {_half(first, second):.1%}", hours


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
        [name, *(f"{share:.1%}" for share in room.udi)]
        for name, room in zip(sensors.names, rooms, strict=True)
    ]
    columns = ["plane", "below 100 lx", "100 to 300 lx", "300 to 3000 lx", "above 3000 lx"]
    return Table("Useful daylight illuminance, share of 8:00 to 18:00", columns, rows)


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
        f"{blinds:.0%} through, evenly. 'Unshaded' is the same without blinds. ASE 1000/250: share "
        "with more than 1,000 lx of direct sun alone in more than 250 of these hours.",
        "EN 17037: illuminance on 50 % and on 95 % of the plane, 0.5 m from walls, in half of the "
        "4,380 hours with most light outdoors; minimum, medium, high are 300/100, 500/300, 750/500 "
        "lx, and 300, 500, 750 lx on 95 % where most openings are in the roof. Hours of sun are "
        "the best place's in a room's openings, 1.2 m above the floor. The view out is left out.",
        f"Bounces of sunlit surfaces are solved every {DAYS_BETWEEN} days and interpolated; the "
        "sun's own light is a ray for each sensor and hour.",
    ]

"""What the command writes: tables, plans, a page, and lines for the terminal."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from light_transport.daylight_numbers.cie_skies import TITLES, CieSky, cie_hour
from light_transport.daylight_numbers.numbers_now import numbers_now
from light_transport.daylight_numbers.opened_scene import OpenedScene
from light_transport.daylight_numbers.patch_error import patch_error
from light_transport.daylight_numbers.plan_picture import Quantity, plan_picture
from light_transport.daylight_numbers.report import Page, Table, write_report
from light_transport.daylight_numbers.sensors import Sensors
from light_transport.daylight_numbers.sun_hours import STEP_MINUTES, sun_hours
from light_transport.daylight_numbers.tables import write_tables
from light_transport.daylight_numbers.work import Grid, Work, work_of
from light_transport.daylight_numbers.year_pages import Numbers, year_pages
from vrut_lite.numeric_types import FloatArray
from vrut_lite.pictures.image_files import write_png
from vrut_lite.project import Project

Tracked = Callable[[Iterable[int], str, int], Iterable[int]]
_PICTURES = {
    "illuminance_lx": Quantity("illuminance", "lx"),
    "daylight_factor_percent": Quantity("daylight factor", "%"),
    "sun_h": Quantity("hours of sun", "h"),
}


@dataclass(frozen=True, eq=False)
class Asked:
    """What is computed: of a project, at sensors, within a tolerance, under a CIE sky."""

    project: Project
    sensors: Sensors | Grid
    tolerance: float
    cie_sky: CieSky
    ground_albedo: float
    year: bool


def write_daylight(folder: Path, opened: OpenedScene, asked: Asked, tracked: Tracked) -> list[str]:
    """Compute and write; returns a line for each plane. `tracked` shows the progress of steps.

    Raises:
        UserError: there are no work planes, sensors lie in walls, or a file cannot be written.
    """
    work = work_of(opened.scene, asked.sensors, asked.tolerance)
    numbers = _now(work, opened, asked)
    tables = [_rooms_now(work.sensors, numbers)]
    pictures: dict[Path, str] = {}
    for name, quantity in _PICTURES.items():
        if np.any(work.sensors.cell >= 0) and np.any(numbers[name] > 0.0):
            path = folder / f"{name}.png"
            write_png(path, plan_picture(work.sensors, numbers[name], quantity))
            pictures[path] = f"{quantity.title.capitalize()} ({quantity.unit}), north (-z) up"
    overcast = cie_hour(asked.cie_sky, asked.ground_albedo)
    factor = numbers["daylight_factor_percent"]
    moved = patch_error(opened.scene, work, asked.tolerance, overcast, factor)
    method = _method(work, asked, moved)
    if asked.year:
        found = year_pages(folder, work, opened, lambda steps, count: tracked(steps, "year", count))
        numbers |= found.columns
        tables += found.tables
        pictures |= found.pictures
        method += found.method
    write_tables(folder, work.sensors, numbers)
    where = asked.project
    subtitle = f"{where.at} at {where.place}; sky by {opened.source}; {len(work.sensors)} sensors"
    title = f"Daylight of {Path(where.scene).stem}"
    write_report(folder / "report.html", Page(title, subtitle, tables, pictures, method))
    lines = [
        f"{table.heading}: "
        + "; ".join(
            f"{row[0]}: "
            + ", ".join(
                f"{name} {cell}" for name, cell in zip(table.columns[1:], row[1:], strict=True)
            )
            for row in table.rows
        )
        for table in tables
    ]
    return [*lines, f"the page is {folder / 'report.html'}"]


def _now(work: Work, opened: OpenedScene, asked: Asked) -> Numbers:
    """Columns (P,) of the present hour, named with their units; errors are standard errors."""
    now = numbers_now(work, opened.hour(), asked.cie_sky, asked.ground_albedo)
    hour = now.light
    midnight = asked.project.instant().replace(hour=0, minute=0, second=0, microsecond=0)
    return {
        "illuminance_lx": hour.total,
        "illuminance_error_lx": hour.noise,
        "of_sun_lx": hour.sun,
        "of_sky_lx": hour.sky,
        "of_surfaces_lx": hour.surfaces,
        "daylight_factor_percent": now.daylight_factor_percent,
        "daylight_factor_error_percent": now.daylight_factor_error_percent,
        "sky_view": now.sky_view,
        "sun_h": sun_hours(work, opened, midnight),
    }


def _rooms_now(sensors: Sensors, numbers: Numbers) -> Table:
    rows = []
    for plane, name in enumerate(sensors.names):
        here = sensors.plane == plane
        lux, factor = numbers["illuminance_lx"][here], numbers["daylight_factor_percent"][here]
        noise = numbers["illuminance_error_lx"][here]
        factor_noise = numbers["daylight_factor_error_percent"][here]
        rows.append(
            [
                name,
                f"{here.sum()}",
                f"{lux.mean():,.0f} ± {_rms(noise):,.0f}",
                f"{lux.min():,.0f}",
                f"{lux.max():,.0f}",
                f"{factor.mean():.2f} ± {_rms(factor_noise):.2f}",
                f"{np.median(factor):.2f}",
                f"{numbers['sky_view'][here].mean():.1%}",
                f"{numbers['sun_h'][here].mean():.1f}",
            ]
        )
    columns = [
        "plane", "sensors", "mean lx", "least lx", "most lx", "mean daylight factor %",
        "median daylight factor %", "sky view", "hours of sun",
    ]  # fmt: skip
    return Table("The hour, and an overcast sky", columns, rows)


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _method(work: Work, asked: Asked, moved: float) -> list[str]:
    bake = work.bake
    assert bake.patches is not None
    step = max(work.sensors.step_m)
    planes = (
        f"Sensors stand in cells of {step:.2f} m, facing up."
        if step > 0.0
        else "Sensors are those of a file."
    )
    return [
        planes,
        f"Daylight factor under {TITLES[asked.cie_sky]}, ground albedo {asked.ground_albedo:g}.",
        f"{work.operator.rays:,.0f} rays from each sensor in two halves; after ± stands a sensor's "
        "standard error (rms) by the difference of the halves.",
        f"Bounces between {len(bake.patches.area):,} patches of Lambert's surfaces, "
        f"{bake.rays} rays from each of {len(bake.texels.pixel):,} texels (docs/light.md). "
        f"Patches twice as wide move daylight factors by {moved:.1%} of their mean, rms.",
        "Glass passes light by the angle at which a sensor sees through it; bounces by its mean.",
        f"Hours of sun of the day in steps of {STEP_MINUTES} minutes.",
        "Lamps are off. Blinds, mirrors' images of the sun and glare are not computed.",
    ]

"""Columns, tables and a plan of lamps at full output for the command's folder."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from daylight_numbers.lamps.lighting import Lighting
from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.pictures import PictureQuantity, plan_picture
from daylight_numbers.report import Table
from vrut_lite.headless import write_png
from vrut_lite.numeric_types import FloatArray

_PLAN = "of_lamps_lx"


class LampPages(NamedTuple):
    """The lamps' part of tables and page."""

    columns: dict[str, FloatArray]
    tables: list[Table]
    pictures: dict[Path, str]
    method: list[str]


def lamp_pages(folder: Path, sensors: Sensors, lighting: Lighting) -> LampPages:
    """Write the plan, and return columns (P,), tables and sentences.

    Raises:
        UserError: the picture cannot be written.
    """
    columns = {
        _PLAN: lighting.light.total.sum(axis=1),
        "of_lamps_error_lx": np.sqrt((lighting.light.noise**2).sum(axis=1)),
        "of_lamps_maintained_lx": lighting.maintained_lux.sum(axis=1),
    }
    pictures: dict[Path, str] = {}
    if np.any(sensors.cell >= 0) and np.any(columns[_PLAN] > 0.0):
        path = folder / f"{_PLAN}.png"
        write_png(path, plan_picture(sensors, columns[_PLAN], PictureQuantity("lamps alone", "lx")))
        pictures[path] = "Illuminance of lamps alone at full output (lx), north (-z) up"
    tables = [_groups(lighting), _planes(sensors, columns)]
    return LampPages(columns, tables, pictures, _method(lighting))


def _groups(lighting: Lighting) -> Table:
    lamps = lighting.lamps
    rows = []
    for group, name in enumerate(lamps.groups):
        here = lamps.group == group
        flux, watts = float(lamps.flux_lm[here].sum()), float(lamps.group_watts[group])
        zone = lighting.zones[group]
        rows.append(
            [
                name,
                f"{here.sum()}",
                f"{flux:,.0f}",
                f"{watts:,.1f}",
                f"{flux / watts:,.0f}" if watts > 0.0 else "power is not told",
                f"{zone.sum()}",
                f"{lighting.maintained_lux[zone].sum(axis=1).mean():,.0f}",
            ]
        )
    columns = [
        "group", "lamps", "lm", "W", "lm/W", "sensors of its zone", "maintained lx by all lamps",
    ]  # fmt: skip
    return Table("Lamps", columns, rows)


def _planes(sensors: Sensors, columns: dict[str, FloatArray]) -> Table:
    rows = []
    for plane, name in enumerate(sensors.names):
        here = sensors.plane == plane
        lux, noise = columns[_PLAN][here], columns["of_lamps_error_lx"][here]
        mean = lux.mean()
        rows.append(
            [
                name,
                f"{mean:,.0f} ± {np.sqrt(np.mean(noise**2)):,.1f}",
                f"{lux.min():,.0f}",
                f"{lux.max():,.0f}",
                f"{lux.min() / mean:.2f}" if mean > 0.0 else "",
                f"{columns['of_lamps_maintained_lx'][here].mean():,.0f}",
            ]
        )
    names = ["plane", "mean lx", "least lx", "most lx", "least over mean", "maintained mean lx"]
    return Table("Lamps alone, at full output", names, rows)


def _method(lighting: Lighting) -> list[str]:
    count = len(lighting.lamps)
    return [
        f"{count} luminaires in {len(lighting.lamps.groups)} groups, white: inverse square and "
        "cosine from their files' intensity, shadow rays through glass by angle; openings are cut "
        "into points from 15 times their size on. Bounces go between the patches of daylight's.",
        "Maintained lux are those of aged lamps, by the maintenance factor of each group.",
    ]

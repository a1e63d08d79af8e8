"""What the command writes: tables, plans, and lines for the terminal."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from light_transport.daylight_numbers.cie_skies import TITLES, CieSky, cie_hour
from light_transport.daylight_numbers.now import daylight_factor, hour_at_sensors, sky_view
from light_transport.daylight_numbers.opened_scene import OpenedScene
from light_transport.daylight_numbers.plan_picture import Quantity, plan_picture
from light_transport.daylight_numbers.sensors import Sensors
from light_transport.daylight_numbers.tables import write_tables
from light_transport.daylight_numbers.work import Grid, Work, work_of
from vrut_lite.numeric_types import FloatArray
from vrut_lite.pictures.image_files import write_png
from vrut_lite.project import Project


@dataclass(frozen=True, eq=False)
class Asked:
    """What is computed: of a project, at sensors, within a tolerance, under a CIE sky."""

    project: Project
    sensors: Sensors | Grid
    tolerance: float
    cie_sky: CieSky
    ground_albedo: float


def write_daylight(folder: Path, opened: OpenedScene, asked: Asked) -> list[str]:
    """Compute and write; returns a line for each plane.

    Raises:
        UserError: there are no work planes, sensors lie in walls, or a file cannot be written.
    """
    work = work_of(opened.scene, asked.sensors, asked.tolerance)
    numbers = numbers_now(work, opened, asked)
    write_tables(folder, work.sensors, numbers)
    for name, quantity in _PICTURES.items():
        if np.any(work.sensors.cell >= 0):
            pixels = plan_picture(work.sensors, numbers[name], quantity)
            write_png(folder / f"{name}.png", pixels)
    return [*_said(work.sensors, numbers), f"sky of the daylight factor: {TITLES[asked.cie_sky]}"]


_PICTURES = {
    "illuminance_lx": Quantity("illuminance", "lx"),
    "daylight_factor_percent": Quantity("daylight factor", "%"),
}


def numbers_now(work: Work, opened: OpenedScene, asked: Asked) -> dict[str, FloatArray]:
    """Columns (P,) of the present hour, named with their units; errors are standard errors."""
    hour = hour_at_sensors(work.bake, work.glass, work.operator, work.sensors, opened.hour())
    light = cie_hour(asked.cie_sky, asked.ground_albedo)
    factor, factor_error = daylight_factor(
        work.bake, work.glass, work.operator, work.sensors, light
    )
    return {
        "illuminance_lx": hour.total,
        "illuminance_error_lx": hour.noise,
        "of_sun_lx": hour.sun,
        "of_sky_lx": hour.sky,
        "of_surfaces_lx": hour.surfaces,
        "daylight_factor_percent": factor,
        "daylight_factor_error_percent": factor_error,
        "sky_view": sky_view(work.operator),
    }


def _said(sensors: Sensors, numbers: dict[str, FloatArray]) -> list[str]:
    lines = []
    for plane, name in enumerate(sensors.names):
        here = sensors.plane == plane
        lux, factor = numbers["illuminance_lx"][here], numbers["daylight_factor_percent"][here]
        error = numbers["illuminance_error_lx"][here]
        lines.append(
            f"{name}: {here.sum()} sensors, {lux.mean():,.0f} lx in the mean "
            f"(least {lux.min():,.0f}, most {lux.max():,.0f}, rays err by "
            f"{np.sqrt(np.mean(error**2)) / max(lux.mean(), 1e-9):.1%}), "
            f"daylight factor {factor.mean():.2f} % (median {np.median(factor):.2f} %)"
        )
    return lines

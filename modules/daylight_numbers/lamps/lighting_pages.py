"""A year of lamps for the command's folder: tables, columns, an hourly table and heat maps."""

import csv
from pathlib import Path
from typing import Any

import numpy as np

from daylight_numbers.lamps.lamp_pages import LampPages
from daylight_numbers.lamps.lighting import Lighting
from daylight_numbers.lamps.lighting_year import LightingYear, lighting_year, lit_areas_m2
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.pictures import PictureQuantity, heat_map
from daylight_numbers.report import Table
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.year import LUMENS_RGB, SolvedYear, year_matrices, year_of
from daylight_numbers.year.year_light import DAYS, HOURS, YearLight, middle_of
from vrut_lite.errors import UserError
from vrut_lite.headless import write_png
from vrut_lite.messages.lighting import LightingControl
from vrut_lite.numeric_types import Float32Array, FloatArray
from vrut_lite.quantities import percent_text
from vrut_lite.write_atomic import atomic_output

_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
_HOURS_FILE, _POWER = "lighting_hours.csv", "lighting_power.png"
_PHOTOSENSOR_TOLERANCE = 0.02
_TITLES = {
    "always_on": "always on",
    "on_off": "on and off",
    "open_loop": "open loop",
    "closed_loop": "closed loop",
}


def lighting_pages(
    folder: Path,
    work: DaylightWork,
    lighting: Lighting,
    daylight: Float32Array,
    light: YearLight,
    solved: SolvedYear,
) -> LampPages:
    """Compute the year of lamps, and write its hours and a heat map of power.

    Args:
        folder: of the command.
        work: its sensors.
        lighting: lamps at full output.
        daylight: (P, H), lux at sensors, under blinds where they hang.
        light: hours (H).
        solved: bounces of these, for photosensors.

    Raises:
        UserError: a file cannot be written, or a photosensor lies in a body.
    """

    def on_photosensor(control: LightingControl) -> FloatArray:
        return photosensor_lux(work, control, light, solved)

    year = lighting_year(lighting, daylight, light.hour, on_photosensor)
    of_groups, area = lit_areas_m2(lighting, work.sensors)
    _write_hours(folder / _HOURS_FILE, lighting, year)
    power = (year.watts + year.standby_watts).sum(axis=0).reshape(DAYS, HOURS).T
    write_png(
        folder / _POWER,
        heat_map(power, "Power of lamps, standard time", PictureQuantity("power", "W")),
    )
    return LampPages(
        {"target_met_percent": 100.0 * year.met_at_sensors},
        [_of_groups(lighting, year, of_groups), _of_months(lighting, year, area)],
        {folder / _POWER: "Power of all lamps, hour by hour of the year"},
        _method(lighting, year, area),
    )


def photosensor_lux(
    work: DaylightWork, control: LightingControl, light: YearLight, solved: SolvedYear
) -> FloatArray:
    """Daylight (H,) in lux on the photosensor of an open loop; no blind is before it.

    Raises:
        UserError: it lies in a body.
    """
    if control.photosensor is None:
        height = np.maximum(light.sun_direction[:, 1], 0.0)
        return np.asarray(light.diffuse_lux + (light.sun_irradiance_rgb @ LUMENS_RGB) * height)
    at = np.array([control.photosensor], float)
    sensors = free_sensors(at[:, :3], at[:, 3:], "the photosensor")
    try:
        operator = operator_of(
            work.transport, work.glass, sensors, _PHOTOSENSOR_TOLERANCE, work.transport.threads,
            bounces=work.operator.bounces,
        )  # fmt: skip
    except UserError as error:
        raise UserError(f"the photosensor of an open loop: {error}") from None
    there = DaylightWork(work.transport, work.glass, sensors, operator)
    return np.asarray(year_of(year_matrices(there, light, solved), light).total[0], float)


def _of_groups(lighting: Lighting, year: LightingYear, area_m2: FloatArray) -> Table:
    rows = []
    for group, name in enumerate(lighting.lamps.groups):
        control, watts = lighting.controls[group], float(lighting.lamps.group_watts[group])
        hours = float(year.occupied[group].sum())
        light, standby = year.light_kwh[group].sum(), year.standby_kwh[group].sum()
        always = watts * hours / 1000.0
        rows.append(
            [
                name,
                f"{_TITLES[control.control]}, {control.target_lx:,.0f} lx",
                f"{hours:,.0f}",
                f"{light:,.1f} + {standby:,.1f}",
                _over(light + standby, area_m2[group]),
                f"{1000.0 * light / watts:,.0f}" if watts > 0.0 else "",
                percent_text(1.0 - light / always, 1) if always > 0.0 else "",
                percent_text(year.met_alone[group], 1),
                percent_text(year.met[group], 1),
            ]
        )
    columns = [
        "group", "control", "occupied h", "kWh of light + standby", "kWh/m²", "full-power h",
        "saved of always on", "target met by daylight", "with lamps",
    ]  # fmt: skip
    return Table("A year of lamps", columns, rows)


def _of_months(lighting: Lighting, year: LightingYear, area_m2: float) -> Table:
    energy = year.light_kwh + year.standby_kwh
    names = lighting.lamps.groups
    rows = [
        [month, *(f"{value:,.2f}" for value in energy[:, n]), f"{energy[:, n].sum():,.2f}",
         _over(energy[:, n].sum(), area_m2)]
        for n, month in enumerate(_MONTHS)
    ]  # fmt: skip
    sums = energy.sum(axis=1)
    rows.append(
        ["year", *(f"{value:,.1f}" for value in sums), f"{sums.sum():,.1f}",
         _over(sums.sum(), area_m2)]
    )  # fmt: skip
    return Table("Energy of lamps by months, kWh", ["month", *names, "all", "kWh/m²"], rows)


def _over(energy: float, area_m2: float) -> str:
    return f"{energy / area_m2:.2f}" if area_m2 > 0.0 else "no grid"


def _write_hours(path: Path, lighting: Lighting, year: LightingYear) -> None:
    names = lighting.lamps.groups
    heading = ["month", "day", "hour"]
    for name in names:
        heading += [f"{name}: {part}" for part in ("output", "W", "daylight_lx", "total_lx")]
    with (
        atomic_output(path) as beside,
        beside.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.writer(file)
        writer.writerow(heading)
        watts = year.watts + year.standby_watts
        for hour in range(DAYS * HOURS):
            when = middle_of(hour, 0.0)
            cells: list[Any] = [when.month, when.day, when.hour]
            for n in range(len(names)):
                numbers = (
                    year.output[n, hour], watts[n, hour], year.daylight_lx[n, hour],
                    year.total_lx[n, hour],
                )  # fmt: skip
                cells += [f"{value:.5g}" for value in numbers]
            writer.writerow(cells)


def _method(lighting: Lighting, year: LightingYear, area_m2: float) -> list[str]:
    leni = "sensors in no grid have no area: no LENI"
    if area_m2 > 0.0:
        light, standby = (part.sum() / area_m2 for part in (year.light_kwh, year.standby_kwh))
        leni = (
            f"LENI (EN 15193-1) is W_L / A + W_P / A = {light:.2f} + {standby:.2f} = "
            f"{light + standby:.2f} kWh/m² a year for the {area_m2:,.1f} m² of the grids' cells, "
            "without charging of emergency lighting"
        )
    kinds = ", ".join(sorted({_TITLES[control.control] for control in lighting.controls}))
    return [
        f"Controls of lamps: {kinds}. A group's zone are the sensors whose brightest group it is; "
        "its mean illuminance is controlled, by daylight under blinds as in sDA and maintained "
        "light of lamps. On and off go by the minute, dimming by hours.",
        "Closed loops take the least power that brings all their zones to the targets; groups "
        "that nobody uses stay off.",
        f"{leni}. Hours in the dark count.",
    ]

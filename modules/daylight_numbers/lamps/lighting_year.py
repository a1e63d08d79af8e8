"""A year of lamps under their controls: output, power, light in zones, and energy.

All 8,760 hours count, for lamps are on in those without daylight. LENI is that of EN 15193-1:2017,
(W_L + W_P) / A, with W_L by simulated hours in place of its factors of daylight, presence and
constant light; charging of emergency lighting is not in it.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from daylight_numbers.lamps.closed_loops import ClosedLoops
from daylight_numbers.lamps.lighting import Lighting
from daylight_numbers.lamps.lighting_controls import (
    by_hour,
    dimmed_by_photosensor,
    lit_minutes,
    occupied_minutes,
    power_share,
)
from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.year.year_light import DAYS, HOURS
from vrut_lite.messages.lighting import LightingControl
from vrut_lite.numeric_types import Float32Array, FloatArray, IntArray

_MONTH_DAYS = (31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)
# Light that misses the target by less than this share meets it.
_NEARLY = 1e-3


@dataclass(frozen=True, eq=False)
class LightingYear:
    """Groups (G) of lamps in the 8,760 hours (T) of a year.

    Attributes:
        output: (G, T), light of a group as a share of its full one, mean of the hour.
        watts: (G, T), mean power of light; `standby_watts` (G, T) that while it is off.
        daylight_lx, total_lx: (G, T), mean illuminance of each group's zone.
        occupied: (G, T), share of the hour.
        met: (G,), share of occupied hours in which the zone's mean reaches the target; `met_alone`
            (G,) by daylight alone.
        met_at_sensors: (P,), share of the occupied hours of a sensor's group in which the sensor
            has its target; nan where it has no lamps.
    """

    output: FloatArray
    watts: FloatArray
    standby_watts: FloatArray
    daylight_lx: FloatArray
    total_lx: FloatArray
    occupied: FloatArray
    met: FloatArray
    met_alone: FloatArray
    met_at_sensors: FloatArray

    @property
    def light_kwh(self) -> FloatArray:
        """Energy (G, 12) of light by months, kWh."""
        return _by_month(self.watts)

    @property
    def standby_kwh(self) -> FloatArray:
        """Energy (G, 12) of standby by months, kWh."""
        return _by_month(self.standby_watts)


def _by_month(watts: FloatArray) -> FloatArray:
    ends = np.cumsum(_MONTH_DAYS)[:-1] * HOURS
    return np.stack([part.sum(axis=1) for part in np.split(watts, ends, axis=1)], axis=1) / 1000.0


def lighting_year(
    lighting: Lighting,
    daylight: Float32Array,
    hour: IntArray,
    photosensor_lux: Callable[[LightingControl], FloatArray],
) -> LightingYear:
    """The year of groups of lamps.

    Args:
        lighting: at full output.
        daylight: (P, H), lux at sensors, of those `hour` (H,) of the year that have some.
        hour: numbers of hours.
        photosensor_lux: lux (H,) on the photosensor of a control.
    """
    zones, controls, count = lighting.zones, lighting.controls, len(lighting.controls)
    day = np.zeros((count, DAYS * HOURS))
    day[:, hour] = [daylight[zone].mean(axis=0, dtype=float) for zone in zones]
    full = np.array([lighting.maintained_lux[zone].mean(axis=0) for zone in zones])
    installed = lighting.lamps.group_watts
    used = np.array([by_hour(occupied_minutes(control, DAYS)) for control in controls])
    # Output while a group is on, and the share of each hour in which it is.
    dimmed, on = np.zeros((2, *day.shape))
    for n, control in enumerate(controls):
        match control.control:
            case "always_on":
                dimmed[n], on[n] = 1.0, used[n]
            case "on_off":
                dimmed[n], on[n] = 1.0, by_hour(lit_minutes(control, day[n]))
            case "open_loop":
                lux = np.zeros(day.shape[1])
                lux[hour] = photosensor_lux(control)
                dimmed[n], on[n] = dimmed_by_photosensor(control, lux), used[n]
    loops = np.flatnonzero([control.control == "closed_loop" for control in controls])
    if len(loops):
        closed = ClosedLoops(
            tuple(controls[n] for n in loops), installed[loops], full[np.ix_(loops, loops)]
        )
        others = day + full @ _while_used(dimmed * on, used)
        dimmed[loops] = closed.output(others[loops], used[loops] > 0.0)
        on[loops] = (dimmed[loops] > 0.0) * used[loops]
    shares = [power_share(control, one) for control, one in zip(controls, dimmed, strict=True)]
    standby = np.array([control.standby_w for control in controls])[:, None] * (1.0 - on)
    target = np.array([control.target_lx for control in controls]) * (1.0 - _NEARLY)
    while_used = _while_used(dimmed * on, used)
    total = day + full @ while_used
    hours = used.sum(axis=1)
    return LightingYear(
        dimmed * on,
        installed[:, None] * np.array(shares) * on,
        standby,
        day,
        total,
        used,
        (used * (total >= target[:, None])).sum(axis=1) / hours,
        (used * (day >= target[:, None])).sum(axis=1) / hours,
        _met_at_sensors(lighting, daylight, hour, while_used, used, target),
    )


def _while_used(output: FloatArray, used: FloatArray) -> FloatArray:
    """Output (G, T) as its mean over the used part of each hour, not over the whole."""
    return np.divide(output, used, out=np.zeros_like(output), where=used > 0.0)


def _met_at_sensors(
    lighting: Lighting,
    daylight: Float32Array,
    hour: IntArray,
    output: FloatArray,
    used: FloatArray,
    target: FloatArray,
) -> FloatArray:
    found = np.full(len(daylight), np.nan)
    lux = lighting.maintained_lux
    for group, zone in enumerate(lighting.zones):
        for sensor in np.flatnonzero(zone):
            total = lux[sensor] @ output
            total[hour] += daylight[sensor]
            found[sensor] = np.average(total >= target[group], weights=used[group])
    return found


def lit_areas_m2(lighting: Lighting, sensors: Sensors) -> tuple[FloatArray, float]:
    """Areas (G,) of zones in grids and of all of them, in square metres; 0 for sensors in none."""
    cell = np.array(sensors.step_m)[sensors.plane] ** 2
    zones = lighting.zones
    return zones @ cell, float(cell[zones.any(axis=0)].sum())

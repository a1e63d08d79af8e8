"""Controls of lamps by the hour and the minute; closed loops stand in `closed_loops.py`.

See `LightingControl` for what each does.
"""

import numpy as np

from vrut_lite.messages.lighting import LightingControl
from vrut_lite.numeric_types import BoolArray, FloatArray

MINUTES = 60
_WEEK, _WORKDAYS, _FIRST_WEEKDAY = 7, 5, 2
_DAY_H = 24


def occupied_minutes(control: LightingControl, days: int) -> BoolArray:
    """Which minutes (days * 1440,) are occupied, the first day a Wednesday; standard time."""
    first, last = (round(MINUTES * hour) for hour in control.occupied_h)
    minute = np.arange(days * _DAY_H * MINUTES)
    day, clock = np.divmod(minute, _DAY_H * MINUTES)
    used = (clock >= first) & (clock < last)
    if first > last:
        # After midnight the day before counts.
        used = (clock >= first) | (clock < last)
        day = day - (clock < last)
    if control.weekdays_only:
        used &= (day + _FIRST_WEEKDAY) % _WEEK < _WORKDAYS
    return np.asarray(used)


def by_hour(minutes: BoolArray) -> FloatArray:
    """Shares (H,) of hours by their minutes (60 H,)."""
    return np.asarray(minutes.reshape(-1, MINUTES).mean(axis=1))


def lit_minutes(control: LightingControl, daylight_lx: FloatArray) -> BoolArray:
    """Minutes (60 H,) in which `on_off` has lamps on, by daylight in the middle of hours (H,).

    Daylight is linear between middles. Lamps go on at once in occupied minutes whose daylight is
    below the target, and off when it has reached it for the delay.
    """
    hours = len(daylight_lx)
    minute = np.arange(MINUTES * hours)
    lux = np.interp((minute + 0.5) / MINUTES, np.arange(hours) + 0.5, daylight_lx)
    below = np.where(lux < control.target_lx, minute, -control.delay_min - 1)
    bright_for = minute - np.maximum.accumulate(below)
    occupied = occupied_minutes(control, hours // _DAY_H)
    return np.asarray(occupied & (bright_for <= control.delay_min))


def dimmed_by_photosensor(control: LightingControl, photosensor_lx: FloatArray) -> FloatArray:
    """Output (T,) of `open_loop`: linear from full in the dark to the least at `dark_at_lx`."""
    assert control.dark_at_lx is not None
    left = 1.0 - (1.0 - control.min_dimming) * photosensor_lx / control.dark_at_lx
    return np.asarray(np.maximum(left, control.min_dimming))


def power_share(control: LightingControl, output: FloatArray) -> FloatArray:
    """Share of the full power at an output: linear from the least one on, 0 where off."""
    m, p = control.min_dimming, control.min_power
    slope = (1.0 - p) / (1.0 - m) if m < 1.0 else 0.0
    at_least = np.where(output >= 1.0, 1.0, p + slope * (output - m))
    return np.asarray(np.where(output > 0.0, at_least, 0.0))

"""Controls of lamps: output of groups by daylight, at any times; see `LightingControl`.

A closed loop finds the least power that brings every zone to its target: with output d and a switch
u of each group, min sum P (p u + (1 - p) (d - m u) / (1 - m)) subject to A d >= b, m u <= d <= u,
a mixed-integer linear program. What lamps cannot reach is made as small as possible first.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp

from vrut_lite.errors import UserError
from vrut_lite.messages.lighting import LightingControl
from vrut_lite.numeric_types import BoolArray, FloatArray

MINUTES = 60
_WEEK, _WORKDAYS, _FIRST_WEEKDAY = 7, 5, 2
_DAY_H = 24
# Cost of light that is missing, a share of the target: far above that of any lamp's power.
_MISSING_COST = 1e3
# Relative gap at which a program is solved.
_GAP = 1e-6


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


class ClosedLoops(NamedTuple):
    """Groups (G) in closed loops: controls, full power (G,), and maintained lux (G, G) that a group
    (column) at full output brings to the zone of a group (row)."""

    controls: tuple[LightingControl, ...]
    watts: FloatArray
    lux: FloatArray

    def output(self, other_lx: FloatArray, occupied: BoolArray) -> FloatArray:
        """Output (G, T) at times.

        Args:
            other_lx: (G, T), daylight and other lamps in the zones.
            occupied: (G, T), groups that are off otherwise, and zones that need no light.
        """
        target = np.array([control.target_lx for control in self.controls])
        missing = np.where(occupied, 1.0 - other_lx / target[:, None], 0.0)
        found = np.zeros(missing.shape)
        needs = np.flatnonzero((missing > 0.0).any(axis=0))
        if len(self.controls) == 1:
            full = self.lux[0, 0] / target[0]
            wanted = missing[0, needs] / max(full, 1e-12)
            found[0, needs] = np.clip(wanted, self.controls[0].min_dimming, 1.0)
            return found
        states = np.concatenate([np.maximum(missing[:, needs], 0.0), occupied[:, needs]])
        kinds, which = np.unique(states, axis=1, return_inverse=True)
        count = len(self.controls)
        solved = [self._solved(kind[:count], kind[count:] > 0.0) for kind in kinds.T]
        found[:, needs] = np.array(solved).reshape(-1, count).T[:, which.ravel()]
        return found

    def _solved(self, missing: FloatArray, may_shine: BoolArray) -> FloatArray:
        """Output (G,) by shares of the targets (G,) that are missing."""
        count = len(self.controls)
        target = np.array([control.target_lx for control in self.controls])
        m = np.array([control.min_dimming for control in self.controls])
        p = np.array([control.min_power for control in self.controls])
        # A group without power costs a little: its output would be any.
        share = self.watts / max(self.watts.sum(), 1e-12) + 1e-6
        slope = np.divide(1.0 - p, 1.0 - m, out=np.zeros(count), where=m < 1.0)
        cost = [share * slope, share * (p - slope * m), np.full(count, _MISSING_COST)]
        eye, none = np.eye(count), np.zeros((count, count))
        light = np.hstack([self.lux / target[:, None], none, eye])
        switched = np.vstack([np.hstack([eye, -eye, none]), np.hstack([-eye, m * eye, none])])
        upper = np.concatenate([may_shine, may_shine, np.full(count, np.inf)])
        result = milp(
            np.concatenate(cost),
            integrality=np.repeat([0, 1, 0], count),
            bounds=Bounds(0.0, upper),
            constraints=[
                LinearConstraint(light, missing, np.inf),
                LinearConstraint(switched, -np.inf, 0.0),
            ],
            options={"mip_rel_gap": _GAP},
        )
        if result.x is None:
            raise UserError(f"closed loops of lamps have no solution: {result.message}")
        on = result.x[count : 2 * count] > 0.5
        return np.where(on, np.clip(result.x[:count], m, 1.0), 0.0)

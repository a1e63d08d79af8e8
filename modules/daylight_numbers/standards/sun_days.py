"""Hours of sun on each of many days, by rays towards the sun in steps of ten minutes.

The sun is that of `vrut_lite.sky.suns` (Michalsky 1988), within 0.02 degrees; days are those of
standard time.
"""

from datetime import UTC, date, datetime, time, timedelta
from typing import NamedTuple

import numpy as np

from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.now import sun_shares
from daylight_numbers.standards.sun_hours import STEP_MINUTES
from daylight_numbers.work import DaylightWork
from vrut_lite.geometry.frames import world_from_enu
from vrut_lite.messages.place import SetPlace
from vrut_lite.numeric_types import BoolArray, FloatArray, IntArray
from vrut_lite.sky.suns import suns_at

_STEPS_A_DAY = 24 * 60 // STEP_MINUTES
# Sensors whose rays are cast together, to bound memory.
_SENSORS_AT_ONCE = 32


class SunSteps(NamedTuple):
    """The sun in the middle of the steps (S) of some days (D) in which it is up.

    Attributes:
        first: the first day.
        days: their number.
        day: (S,), number of each step's day, from 0.
        towards: (S, 3), unit vectors to the sun, world axes.
        elevation_deg: (S,), apparent.
        solar_time_h: (S,), true solar time: the sun is in the meridian at 12.
    """

    first: date
    days: int
    day: IntArray
    towards: FloatArray
    elevation_deg: FloatArray
    solar_time_h: FloatArray

    def some(self, chosen: BoolArray) -> "SunSteps":
        """Those steps that are chosen (S,), of the same days."""
        return self._replace(
            day=self.day[chosen],
            towards=self.towards[chosen],
            elevation_deg=self.elevation_deg[chosen],
            solar_time_h=self.solar_time_h[chosen],
        )

    def hours(self, shines: BoolArray) -> FloatArray:
        """Hours (P, D) of each day by the steps in which the sun shines (P, S)."""
        counts = [np.bincount(self.day, row, self.days) for row in shines]
        return np.array(counts, float).reshape(len(shines), self.days) * (STEP_MINUTES / 60.0)

    def date_of(self, day: int) -> date:
        """The date of a day by its number."""
        return self.first + timedelta(days=int(day))


def sun_steps(place: SetPlace, offset_h: float, first: date, last: date) -> SunSteps:
    """The sun of all days from the first to the last, by standard time `offset_h` ahead of UTC."""
    days = (last - first).days + 1
    midnight = datetime.combine(first, time(), UTC) - timedelta(hours=offset_h)
    step = np.arange(days * _STEPS_A_DAY)
    seconds = midnight.timestamp() + (step + 0.5) * (60.0 * STEP_MINUTES)
    suns = suns_at(seconds, place.latitude_deg, place.longitude_deg, place.altitude_m)
    up = suns.apparent_elevation_rad > 0.0
    latitude = np.radians(place.latitude_deg)
    level = np.cos(suns.elevation_rad)
    # Components of the geometric sun towards east and in the plane of the meridian.
    east = level * np.sin(suns.azimuth_rad)
    south = np.sin(suns.elevation_rad) * np.cos(latitude)
    south -= level * np.cos(suns.azimuth_rad) * np.sin(latitude)
    solar_time_h = 12.0 + np.degrees(np.arctan2(-east, south)) / 15.0
    return SunSteps(
        first,
        days,
        step[up] // _STEPS_A_DAY,
        world_from_enu(suns.east_north_up[up], place.north_offset_rad),
        np.degrees(suns.apparent_elevation_rad[up]),
        solar_time_h[up],
    )


def sun_by_day(work: DaylightWork, sensors: Sensors, steps: SunSteps) -> FloatArray:
    """Hours (P, D) in which the sun shines on the side that a sensor faces.

    Sun through glass counts in full, through measured panes where a part of it passes straight.
    """
    found = np.zeros((len(sensors), steps.days))
    for first in range(0, len(sensors), _SENSORS_AT_ONCE):
        some = np.arange(first, min(first + _SENSORS_AT_ONCE, len(sensors)))
        shares = sun_shares(
            work.transport, work.glass, sensors.some(some), steps.towards, work.operator.panes
        )
        found[some] = steps.hours(np.asarray(shares.any(axis=2)))
    return found

"""Sunrise, noon, sunset and the twilights of a day: roots of the sun's path, by almanacs.

* Sunrise and sunset: the upper limb, with the refraction at its elevation, is on a level
  horizon. (Refraction grows downwards, so a round disc about the refracted centre appears some
  seconds earlier.) For an observer at a height the thinner air counts, the dip of the horizon
  does not.
* Noon: the sun crosses the meridian; at a pole, that of the longitude given.
* Twilights: the geometric elevation of the centre is -6 (civil), -12 (nautical) or -18 deg
  (astronomical).

Any event may be missing: near the poles the sun stays up or down for months.
"""

from collections.abc import Callable, Iterator
from datetime import UTC, date, datetime, time, timedelta, tzinfo
from functools import cache
from itertools import pairwise
from typing import Protocol

import numpy as np

from vrut_lite.atmosphere.refraction import pressure_at_altitude_pa, refraction_of_true_rad
from vrut_lite.sky.visible_disc import MEAN_ANGULAR_RADIUS_RAD

# In their order on an ordinary day.
DAY_EVENTS = (
    "astronomical dawn", "nautical dawn", "civil dawn", "sunrise", "noon",
    "sunset", "civil dusk", "nautical dusk", "astronomical dusk",
)  # fmt: skip
# Between two samples the sun moves 7.5 deg; extremes in between are searched for.
_LOOK = timedelta(minutes=30)
_PRECISION = timedelta(milliseconds=10)
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
_TWILIGHTS_DEG = {"civil": -6.0, "nautical": -12.0, "astronomical": -18.0}

Height = Callable[[datetime], float]


class SunAngles(Protocol):
    """The sun's centre without refraction."""

    @property
    def elevation_rad(self) -> float:
        """Geometric elevation."""

    @property
    def azimuth_rad(self) -> float:
        """From true north, clockwise."""


def civil_day(day: date, time_zone: tzinfo) -> tuple[datetime, datetime]:
    """The two midnights of a day of a time zone, in UTC, which has no changes of clocks."""
    start, end = (
        datetime.combine(day + timedelta(days=n), time(), tzinfo=time_zone).astimezone(UTC)
        for n in (0, 1)
    )
    return start, end


def day_events(
    start: datetime, end: datetime, sun_at: Callable[[datetime], SunAngles], altitude_m: float
) -> dict[str, datetime]:
    """The events from one midnight to the next by name, in order, in UTC, without the missing.

    Where an event happens twice in the day (a midsummer sunset just after one midnight and
    again just before the next) the dawns and sunrise are the first, sunset and the dusks the
    last. Times are good to 0.01 s of this sun's own motion; refraction makes real sunrises differ
    by a minute and more.
    """
    look = cache(sun_at)
    # One sample beyond each end, to find extremes in the day's first or last minutes.
    looks = [start - _LOOK, *_looks(start, end), end, end + _LOOK]
    turning = _with_extremes(looks, lambda when: look(when).elevation_rad)
    instants = [when for when in turning if start <= when <= end]

    def upper_limb(when: datetime) -> float:
        limb = look(when).elevation_rad + MEAN_ANGULAR_RADIUS_RAD
        return limb + float(refraction_of_true_rad(limb, pressure_at_altitude_pa(altitude_m)))

    def westward(when: datetime) -> float:
        return -float(np.sin(look(when).azimuth_rad))

    def above(elevation_deg: float) -> Height:
        return lambda when: look(when).elevation_rad - float(np.radians(elevation_deg))

    rising: dict[str, Height] = {"sunrise": upper_limb, "noon": westward}
    falling: dict[str, Height] = {"sunset": upper_limb}
    for name, elevation_deg in _TWILIGHTS_DEG.items():
        rising[f"{name} dawn"] = falling[f"{name} dusk"] = above(elevation_deg)
    found = {name: [*_roots(instants, height, 1.0)][:1] for name, height in rising.items()}
    found |= {name: [*_roots(instants, height, -1.0)][-1:] for name, height in falling.items()}
    return {name: found[name][0] for name in DAY_EVENTS if found[name]}


def _looks(start: datetime, end: datetime) -> Iterator[datetime]:
    while start < end:
        yield start
        start += _LOOK


def _with_extremes(instants: list[datetime], height: Height) -> list[datetime]:
    """The instants and the extremes between them, between which the height is monotone."""
    heights = [height(when) for when in instants]
    extremes = []
    for i in range(1, len(instants) - 1):
        before, here, after = heights[i - 1 : i + 2]
        if (here - before) * (after - here) <= 0.0:
            sign = 1.0 if here >= before else -1.0
            extremes.append(_highest(instants[i - 1], instants[i + 1], height, sign))
    return sorted({*instants, *extremes})


def _highest(start: datetime, end: datetime, height: Height, sign: float) -> datetime:
    """The instant at which sign times height is largest, by golden-section search."""
    while end - start > timedelta(seconds=1):
        width = _GOLDEN * (end - start)
        left, right = end - width, start + width
        if sign * height(left) < sign * height(right):
            start = left
        else:
            end = right
    return start + (end - start) / 2


def _roots(instants: list[datetime], height: Height, sign: float) -> Iterator[datetime]:
    """The instants at which sign times height passes zero upwards."""
    heights = [sign * height(when) for when in instants]
    for (start, end), (low, high) in zip(pairwise(instants), pairwise(heights), strict=True):
        if low < 0.0 <= high:
            yield _root(start, end, height, sign)


def _root(start: datetime, end: datetime, height: Height, sign: float) -> datetime:
    """The instant at which sign times height becomes positive, by bisection."""
    while end - start > _PRECISION:
        middle = start + (end - start) / 2
        if sign * height(middle) < 0.0:
            start = middle
        else:
            end = middle
    return end

"""The sun's day at a place: sampled every five minutes, with the instants of its events.

The samples come from `SunMoved`, whichever module holds the sun.
"""

from dataclasses import dataclass
from datetime import date, datetime, timedelta, tzinfo

import numpy as np
from numpy.typing import NDArray

from vrut_lite.app.engine.preview_kernel import PreviewKernel
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import SunMoved
from vrut_lite.sky.day_events import civil_day, day_events

_STEP = timedelta(minutes=5)


@dataclass(frozen=True)
class Day:
    """One civil day, from midnight to midnight; 23 hours and 25 too.

    Attributes:
        seconds: (n,) of the samples since the start, the last one at the end.
        elevation_deg: (n,) geometric elevation of the sun's centre.
        azimuth_deg: (n,) from true north, clockwise.
        direction: (n, 3) apparent, world axes.
        marks: instants of the events by name, in order; those that do not happen are left out.
    """

    start: datetime
    end: datetime
    zone: tzinfo
    seconds: NDArray[np.float64]
    elevation_deg: NDArray[np.float64]
    azimuth_deg: NDArray[np.float64]
    direction: NDArray[np.float64]
    marks: dict[str, datetime]

    @property
    def length_s(self) -> float:
        """Seconds from midnight to midnight."""
        return (self.end - self.start).total_seconds()

    def share_of(self, instant: datetime) -> float:
        """The share of an instant: 0 at the first midnight, 1 at the next."""
        return (instant - self.start).total_seconds() / self.length_s

    def instant_at(self, share: float) -> datetime:
        """The instant of a share of the day, kept within it."""
        seconds = min(max(share, 0.0), 1.0) * self.length_s
        # The last moment of the day, not the first of the next.
        return self.start + timedelta(seconds=min(round(seconds), self.length_s - 1.0))

    def elevation_at(self, instant: datetime) -> float:
        """Elevation in degrees, linear between samples: good to 0.001 degrees."""
        seconds = (instant - self.start).total_seconds()
        return float(np.interp(seconds, self.seconds, self.elevation_deg))

    def when_elevation(self, elevation_deg: float, near: datetime) -> datetime | None:
        """The instant at which the sun has an elevation, on the same side of noon if possible, or
        None."""
        return self._nearest(self.elevation_deg - elevation_deg, near)

    def when_azimuth(self, azimuth_deg: float, near: datetime) -> datetime | None:
        """The instant nearest to `near` at which the sun has an azimuth, or None."""
        off = (self.azimuth_deg - azimuth_deg + 180.0) % 360.0 - 180.0
        # A jump from 180 to -180 degrees is no root.
        return self._nearest(np.where(np.abs(off) > 90.0, np.nan, off), near)

    def _nearest(self, off: NDArray[np.float64], near: datetime) -> datetime | None:
        """The zero of a sampled curve that is nearest in time."""
        here, there = off[:-1], off[1:]
        with np.errstate(invalid="ignore", divide="ignore"):
            crosses = (here == 0.0) | (here * there < 0.0)
            roots = self.seconds[:-1] + np.diff(self.seconds) * np.where(
                here == 0.0, 0.0, here / (here - there)
            )
        if not crosses.any():
            return None
        now_s = (near - self.start).total_seconds()
        same_side = crosses & ((self._falls()) == self._falls_at(now_s))
        able = roots[same_side if same_side.any() else crosses]
        return self.start + timedelta(seconds=float(able[np.argmin(np.abs(able - now_s))]))

    def _falls(self) -> NDArray[np.bool_]:
        return np.diff(self.elevation_deg) < 0.0

    def _falls_at(self, seconds: float) -> bool:
        index = int(np.clip(np.searchsorted(self.seconds, seconds) - 1, 0, self.seconds.size - 2))
        return bool(self._falls()[index])


def day_of(second: PreviewKernel, day: date, zone: tzinfo) -> Day | None:
    """A civil day of a time zone, where `second` is set up; None if no module holds the sun."""
    start, end = civil_day(day, zone)
    steps = round((end - start) / _STEP)
    instants = [start + (end - start) * i / steps for i in range(steps + 1)]
    suns = [sun for instant in instants if (sun := second.sun_at(instant)) is not None]
    if len(suns) < len(instants):
        return None

    def sun_at(instant: datetime) -> SunMoved:
        return second.sun_at(instant) or suns[0]

    place = second.kernel.last(SetPlace)
    return Day(
        start=start,
        end=end,
        zone=zone,
        seconds=np.array([(instant - start).total_seconds() for instant in instants]),
        elevation_deg=np.degrees([sun.elevation_rad for sun in suns]),
        azimuth_deg=np.degrees([sun.azimuth_rad for sun in suns]) % 360.0,
        direction=np.array([sun.direction for sun in suns]),
        marks=day_events(start, end, sun_at, 0.0 if place is None else place.altitude_m),
    )

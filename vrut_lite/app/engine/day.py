"""The sun's day at a place: sampled every five minutes, with the instants of its events.

The samples come from `SunMoved`, whichever module holds the sun. Events are roots between two
samples, by the almanacs' conventions: at sunrise and sunset the refracted upper limb stands on a
level horizon; at twilights the centre's geometric elevation is -6, -12 or -18 degrees; at noon the
sun crosses the meridian. Refraction is interpolated from the day's own samples of geometric and
apparent elevation, at the limb's elevation.
"""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, date, datetime, time, timedelta, tzinfo

import numpy as np
from numpy.typing import NDArray

from vrut_lite.app.engine.preview_kernel import PreviewKernel
from vrut_lite.messages.sun import SunMoved

_STEP = timedelta(minutes=5)
_PRECISION_S = 0.5
# The sun's mean angular radius, 16 minutes of arc.
_SUN_RADIUS_RAD = float(np.radians(16.0 / 60.0))
TWILIGHTS_DEG = {"civil": -6.0, "nautical": -12.0, "astronomical": -18.0}
# In their order on an ordinary day.
MARKS = (
    "astronomical dawn", "nautical dawn", "civil dawn", "sunrise", "noon",
    "sunset", "civil dusk", "nautical dusk", "astronomical dusk",
)  # fmt: skip
Height = Callable[[SunMoved], float]


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
    start, end = (
        datetime.combine(day + timedelta(days=n), time(), tzinfo=zone).astimezone(UTC)
        for n in (0, 1)
    )
    steps = round((end - start) / _STEP)
    instants = [start + (end - start) * i / steps for i in range(steps + 1)]
    suns = [sun for instant in instants if (sun := second.sun_at(instant)) is not None]
    if len(suns) < len(instants):
        return None
    return Day(
        start=start,
        end=end,
        zone=zone,
        seconds=np.array([(instant - start).total_seconds() for instant in instants]),
        elevation_deg=np.degrees([sun.elevation_rad for sun in suns]),
        azimuth_deg=np.degrees([sun.azimuth_rad for sun in suns]) % 360.0,
        direction=np.array([sun.direction for sun in suns]),
        marks=_marks(second, instants, suns),
    )


def _marks(
    second: PreviewKernel, instants: list[datetime], suns: list[SunMoved]
) -> dict[str, datetime]:
    def crossing(height: Height, rising: bool) -> datetime | None:
        """The first upward crossing of zero, or the last downward one, to half a second."""
        sign = 1.0 if rising else -1.0
        above = np.array([sign * height(sun) >= 0.0 for sun in suns])
        found = np.flatnonzero(~above[:-1] & above[1:])
        if not found.size:
            return None
        index = int(found[0 if rising else -1])
        low, high = instants[index], instants[index + 1]
        while (high - low).total_seconds() > _PRECISION_S:
            middle = low + (high - low) / 2
            sun = second.sun_at(middle)
            if sun is not None and sign * height(sun) >= 0.0:
                high = middle
            else:
                low = middle
        return high

    limb = _upper_limb(suns)
    found = {
        "sunrise": crossing(limb, rising=True),
        "noon": crossing(lambda sun: float(np.sin(sun.azimuth_rad)), rising=False),
        "sunset": crossing(limb, rising=False),
    }
    for name, elevation_deg in TWILIGHTS_DEG.items():
        height = _above(elevation_deg)
        found[f"{name} dawn"] = crossing(height, rising=True)
        found[f"{name} dusk"] = crossing(height, rising=False)
    return {name: when for name in MARKS if (when := found[name]) is not None}


def _upper_limb(suns: list[SunMoved]) -> Height:
    """Elevation of the refracted upper limb."""
    rising = sorted(suns, key=lambda sun: sun.elevation_rad)
    elevation_rad = np.array([sun.elevation_rad for sun in rising])
    refraction_rad = np.array([sun.apparent_elevation_rad for sun in rising]) - elevation_rad

    def height(sun: SunMoved) -> float:
        limb_rad = sun.elevation_rad + _SUN_RADIUS_RAD
        return limb_rad + float(np.interp(limb_rad, elevation_rad, refraction_rad))

    return height


def _above(elevation_deg: float) -> Height:
    return lambda sun: float(np.degrees(sun.elevation_rad)) - elevation_deg

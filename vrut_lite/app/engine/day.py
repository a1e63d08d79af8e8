"""The sun's day at a place, asked of whichever module holds the sun, on a kernel of its own.

The host knows nothing of suns: it sets a clock and hears `SunMoved`. A second kernel, in which
those modules alone live that can hold the sun, is asked for a whole day without disturbing the
first. Marks are found as roots between looks five minutes apart, by the almanacs' conventions:
sunrise and sunset where the centre's geometric elevation is -50', for refraction and the disc's
radius, twilights where it is -6, -12 and -18 degrees, noon where the sun crosses the meridian.
"""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, date, datetime, time, timedelta, tzinfo

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.sun import SunMoved
from vrut_lite.discovery import discover
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, SetClock, SetSetting

_STEP = timedelta(minutes=5)
_PRECISION_S = 0.5
_HORIZON_DEG = -50.0 / 60.0
TWILIGHTS_DEG = {"civil": -6.0, "nautical": -12.0, "astronomical": -18.0}
# In the order in which they come on an ordinary day.
MARKS = (
    "astronomical dawn", "nautical dawn", "civil dawn", "sunrise", "noon",
    "sunset", "civil dusk", "nautical dusk", "astronomical dusk",
)  # fmt: skip


@dataclass(frozen=True)
class Day:
    """One civil day, from midnight to midnight; 23 hours and 25 too.

    Attributes:
        seconds: (n,) looks, since the start, the last one at the end.
        elevation_deg: (n,) geometric elevation of the sun's centre.
        azimuth_deg: (n,) from true north, clockwise.
        direction: (n, 3) apparent, world axes.
        marks: by name, in order; what does not happen is not in it.
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
        """Where an instant lies: 0 at the first midnight, 1 at the next."""
        return (instant - self.start).total_seconds() / self.length_s

    def instant_at(self, share: float) -> datetime:
        """The instant of a share of the day, kept within it."""
        seconds = min(max(share, 0.0), 1.0) * self.length_s
        # The last moment of the day, not the first of the next.
        return self.start + timedelta(seconds=min(round(seconds), self.length_s - 1.0))

    def elevation_at(self, instant: datetime) -> float:
        """Elevation in degrees, between looks by a straight line: good to 0.001 degrees."""
        seconds = (instant - self.start).total_seconds()
        return float(np.interp(seconds, self.seconds, self.elevation_deg))

    def when_elevation(self, elevation_deg: float, near: datetime) -> datetime | None:
        """When the sun stands so high, on the same side of noon if it does there, or None."""
        return self._nearest(self.elevation_deg - elevation_deg, near)

    def when_azimuth(self, azimuth_deg: float, near: datetime) -> datetime | None:
        """When the sun stands in this direction, the time nearest to `near`, or None."""
        off = (self.azimuth_deg - azimuth_deg + 180.0) % 360.0 - 180.0
        # A jump from 180 to -180 degrees is no root.
        return self._nearest(np.where(np.abs(off) > 90.0, np.nan, off), near)

    def _nearest(self, off: NDArray[np.float64], near: datetime) -> datetime | None:
        """Where a sampled curve passes zero, nearest in time."""
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


class SunScout:
    """Asks the modules that can hold the sun, on a kernel without anything else."""

    def __init__(self) -> None:
        self._kernel = Kernel()
        for module in discover()[0]:
            if "sun" in module.manifest.provides and not module.brings:
                self._kernel.add_module(module)

    def set_up(self, place: SetPlace, holder: str, settings: dict[str, object]) -> None:
        """Stand at a place and ask this holder, with these settings."""
        if holder in self._kernel.seats:
            self._kernel.inject(ChooseSlot(slot="sun", module=holder))
            for name, value in settings.items():
                self._kernel.inject(SetSetting(module=holder, name=name, value=value))
        self._kernel.inject(place)
        self._kernel.pump()

    def sun_at(self, instant: datetime) -> SunMoved | None:
        """Where the sun stands then; None if no module tells."""
        self._kernel.inject(SetClock(instant=instant))
        self._kernel.pump()
        return self._kernel.last(SunMoved)

    def day(self, day: date, zone: tzinfo) -> Day | None:
        """A civil day of a time zone; None if no module tells of the sun."""
        start, end = (
            datetime.combine(day + timedelta(days=n), time(), tzinfo=zone).astimezone(UTC)
            for n in (0, 1)
        )
        steps = round((end - start) / _STEP)
        instants = [start + (end - start) * i / steps for i in range(steps + 1)]
        suns = [self.sun_at(instant) for instant in instants]
        known = [sun for sun in suns if sun is not None]
        if len(known) < len(suns):
            return None
        return Day(
            start=start,
            end=end,
            zone=zone,
            seconds=np.array([(instant - start).total_seconds() for instant in instants]),
            elevation_deg=np.degrees([sun.elevation_rad for sun in known]),
            azimuth_deg=np.degrees([sun.azimuth_rad for sun in known]) % 360.0,
            direction=np.array([sun.direction for sun in known]),
            marks=self._marks(instants, known),
        )

    def _marks(self, instants: list[datetime], suns: list[SunMoved]) -> dict[str, datetime]:
        found: dict[str, datetime | None] = {
            "sunrise": self._crossing(instants, suns, _above(_HORIZON_DEG), rising=True),
            "noon": self._crossing(instants, suns, _eastward, rising=False),
            "sunset": self._crossing(instants, suns, _above(_HORIZON_DEG), rising=False),
        }
        for name, elevation_deg in TWILIGHTS_DEG.items():
            height = _above(elevation_deg)
            found[f"{name} dawn"] = self._crossing(instants, suns, height, rising=True)
            found[f"{name} dusk"] = self._crossing(instants, suns, height, rising=False)
        return {name: when for name in MARKS if (when := found[name]) is not None}

    def _crossing(
        self,
        instants: list[datetime],
        suns: list[SunMoved],
        height: Callable[[SunMoved], float],
        rising: bool,
    ) -> datetime | None:
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
            sun = self.sun_at(middle)
            if sun is not None and sign * height(sun) >= 0.0:
                high = middle
            else:
                low = middle
        return high


def _eastward(sun: SunMoved) -> float:
    return float(np.sin(sun.azimuth_rad))


def _above(elevation_deg: float) -> Callable[[SunMoved], float]:
    return lambda sun: float(np.degrees(sun.elevation_rad)) - elevation_deg

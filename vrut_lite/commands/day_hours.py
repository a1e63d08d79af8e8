"""Four hours of a day for daylight pictures."""

from datetime import datetime, timedelta

import numpy as np

from vrut_lite.commands.open_kernel import require_sun
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import SetClock

_STEP = timedelta(minutes=2)
_SUNRISE_DEG, _LATE_DEG, _DUSK_DEG = 2.0, 14.0, -4.0


def hours_of_day(kernel: Kernel, midnight: datetime) -> dict[str, datetime]:
    """Instants of sunrise, noon, late afternoon and dusk in the 24 hours after `midnight`.

    Found by asking whoever holds the sun, in steps of two minutes: sunrise and dusk are
    where the geometric elevation is nearest to 2 and -4 degrees, late afternoon to 14, on
    its way up and down. Under a midnight sun these are the nearest that there are.
    """
    instants = [midnight + i * _STEP for i in range(int(timedelta(days=1) / _STEP))]
    elevation_deg = np.array([_elevation_deg(kernel, instant) for instant in instants])
    noon = int(np.argmax(elevation_deg))
    before, after = elevation_deg[: noon + 1], elevation_deg[noon:]
    return {
        "sunrise": instants[_nearest(before, _SUNRISE_DEG)],
        "noon": instants[noon],
        "late afternoon": instants[noon + _nearest(after, _LATE_DEG)],
        "dusk": instants[noon + _nearest(after, _DUSK_DEG)],
    }


def _nearest(elevation_deg: np.ndarray, wanted_deg: float) -> int:
    return int(np.argmin(np.abs(elevation_deg - wanted_deg)))


def _elevation_deg(kernel: Kernel, instant: datetime) -> float:
    kernel.inject(SetClock(instant=instant))
    kernel.pump()
    return float(np.degrees(require_sun(kernel).elevation_rad))

"""The moon's way over a place through the civil days of a date."""

from datetime import UTC, datetime, timedelta
from functools import lru_cache

import astronomy
import numpy as np

from night_sky.sky_axes import Watch, body_km, refracted, watch
from vrut_lite.array import Array
from vrut_lite.messages.moon_path import MoonPathChanged
from vrut_lite.messages.place import SetPlace

# Civil days of a UTC date begin up to 14 hours before it, and end up to 12 hours after it.
_BEFORE, _LENGTH = timedelta(hours=14), timedelta(hours=50)
_STEP = timedelta(minutes=20)
_DAY_S = 86_400.0


def moon_path(instant: datetime, place: SetPlace, source: str) -> MoonPathChanged:
    """The path around the UTC date of an instant: 30 ms, unless it was among the last ones."""
    utc = instant.astimezone(UTC)
    start = utc.replace(hour=0, minute=0, second=0, microsecond=0) - _BEFORE
    return _path_from(start, place, source)


@lru_cache(maxsize=4)
def _path_from(start: datetime, place: SetPlace, source: str) -> MoonPathChanged:
    where = place.latitude_deg, place.longitude_deg, place.altitude_m, place.north_offset_rad
    steps = range(_LENGTH // _STEP + 1)
    places = np.array([_true_direction(watch(start + n * _STEP, *where)) for n in steps])
    begin = watch(start, *where)
    return MoonPathChanged(
        start=start,
        step_s=_STEP.total_seconds(),
        direction=Array(refracted(places).astype(np.float32)),
        rises_s=_crossings_s(begin, astronomy.Direction.Rise),
        sets_s=_crossings_s(begin, astronomy.Direction.Set),
        source=source,
    )


def _true_direction(at: Watch) -> np.ndarray:
    moon = at.world @ body_km(astronomy.Body.Moon, at)
    return np.asarray(moon / np.linalg.norm(moon))


def _crossings_s(begin: Watch, direction: astronomy.Direction) -> tuple[float, ...]:
    """Seconds since the beginning of all rises, or of all sets, within the path."""
    found: list[float] = []
    at, left_days = begin.time, _LENGTH.total_seconds() / _DAY_S
    while left_days > 0.0:
        event = astronomy.SearchRiseSet(
            astronomy.Body.Moon, begin.observer, direction, at, left_days
        )
        if event is None:
            break
        found.append((event.ut - begin.time.ut) * _DAY_S)
        # A minute on, where the moon is past the horizon.
        left_days -= event.ut - at.ut + 60.0 / _DAY_S
        at = event.AddDays(60.0 / _DAY_S)
    return tuple(found)

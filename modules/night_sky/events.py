"""When the moon rises, sets, is full, and when there are eclipses."""

from datetime import UTC, datetime, timedelta
from typing import NamedTuple

import astronomy

from night_sky.sky_axes import Watch

_J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
_FULL_DEG = 180.0
_MONTH_DAYS, _SEARCHED_DAYS = 40.0, 2.0


class SolarEclipse(NamedTuple):
    """An eclipse of the sun as a place sees it: its greatest moment, and the hidden share."""

    at: datetime
    hidden_area: float
    kind: str


def next_rise_and_set(at: Watch) -> tuple[datetime | None, datetime | None]:
    """The moon's next rise and set, None without one within two days."""
    found = (
        astronomy.SearchRiseSet(
            astronomy.Body.Moon, at.observer, direction, at.time, _SEARCHED_DAYS
        )
        for direction in (astronomy.Direction.Rise, astronomy.Direction.Set)
    )
    rise, fall = (None if time is None else _instant(time) for time in found)
    return rise, fall


def next_full_moon(at: Watch) -> datetime:
    """The next instant at which the moon stands opposite the sun."""
    found = astronomy.SearchMoonPhase(_FULL_DEG, at.time, _MONTH_DAYS)
    assert found is not None
    return _instant(found)


def next_solar_eclipse(at: Watch) -> SolarEclipse:
    """The next eclipse of the sun that the place sees, partial or total."""
    found = astronomy.SearchLocalSolarEclipse(at.time, at.observer)
    while found.peak.altitude < 0.0:
        found = astronomy.NextLocalSolarEclipse(found.peak.time, at.observer)
    kind = str(found.kind).rsplit(".", maxsplit=1)[-1].lower()
    return SolarEclipse(_instant(found.peak.time), float(found.obscuration), kind)


def _instant(time: astronomy.Time) -> datetime:
    return _J2000 + timedelta(days=time.ut)

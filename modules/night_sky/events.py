"""When the moon rises, sets, is full, and when there are eclipses."""

from datetime import UTC, datetime, timedelta
from typing import NamedTuple

import astronomy
import numpy as np

from night_sky.eclipse import discs, hidden_area
from night_sky.sky_axes import Watch, body_km, watch
from vrut_lite.atmosphere.refraction import refraction_of_true_rad

_J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
_FULL_DEG = 180.0
_MONTH_DAYS, _SEARCHED_DAYS = 40.0, 2.0
# Hidden share of the sun below which nobody notices an eclipse.
_LEAST_HIDDEN = 0.001


class SolarEclipse(NamedTuple):
    """An eclipse of the sun as a place sees it: its greatest moment, and the hidden share."""

    at: datetime
    hidden_area: float
    kind: str


class _Sight(NamedTuple):
    """The sun at an instant of an eclipse, in days since J2000; lengths in radii of its disc."""

    ut: float
    is_up: bool
    separation: float
    moon_radius: float

    @property
    def hidden_area(self) -> float:
        """Share of the disc behind the moon."""
        return hidden_area(self.separation, self.moon_radius)

    @property
    def kind(self) -> str:
        """As astronomers call it."""
        if self.separation <= self.moon_radius - 1.0:
            return "total"
        return "annular" if self.separation <= 1.0 - self.moon_radius else "partial"


def _sight(ut: float, place: astronomy.Observer) -> _Sight:
    when = _J2000 + timedelta(days=float(ut))
    at = watch(when, place.latitude, place.longitude, place.height)
    sun = at.world @ body_km(astronomy.Body.Sun, at)
    elevation = np.arcsin(sun[1] / np.linalg.norm(sun))
    is_up = bool(elevation + refraction_of_true_rad(elevation) > 0.0)
    return _Sight(float(ut), is_up, *discs(at))


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
    """The next eclipse of the sun that the place sees, when most of the sun that is up is hidden.

    The sun may rise or set eclipsed: its greatest moment here need not be the eclipse's.
    """
    found = astronomy.SearchLocalSolarEclipse(at.time, at.observer)
    while True:
        most: _Sight | None = None
        begin, end = found.partial_begin.time.ut, found.partial_end.time.ut
        # To a minute, then to a second around that.
        for step in (1.0 / 1440.0, 1.0 / 86_400.0):
            seen = [_sight(ut, at.observer) for ut in np.arange(begin, end, step)]
            most = max(
                (one for one in seen if one.is_up),
                key=lambda one: (one.hidden_area, -one.separation),
                default=None,
            )
            if most is None:
                break
            begin, end = most.ut - 1.0 / 1440.0, most.ut + 1.0 / 1440.0
        if most is not None and most.hidden_area > _LEAST_HIDDEN:
            return SolarEclipse(_instant(astronomy.Time(most.ut)), most.hidden_area, most.kind)
        found = astronomy.NextLocalSolarEclipse(found.peak.time, at.observer)


def _instant(time: astronomy.Time) -> datetime:
    return _J2000 + timedelta(days=time.ut)

"""The camera turned to the sun or the moon, where it stands."""

from datetime import datetime
from math import degrees

from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.sun_day_finder import SunDayFinder
from vrut_lite.app.view.viewport import Viewport
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import ClockMoved
from vrut_lite.messages.night import NightLightChanged
from vrut_lite.messages.sun import SunMoved
from vrut_lite.quantities import degrees_text

# Half a disc: the upper limb of a lower body is below the horizon.
_RADIUS_RAD = 0.00465


def look_at_sun(session: Session, scout: SunDayFinder, viewport: Viewport) -> None:
    """Turn the camera to the sun.

    Raises:
        UserError: it is below the horizon.
    """
    sun = session.last(SunMoved)
    if sun is None:
        raise UserError("the sun's place is not computed yet")
    if sun.apparent_elevation_rad < -_RADIUS_RAD:
        low = degrees_text(degrees(-sun.apparent_elevation_rad))
        marks = {} if scout.day is None else scout.day.marks
        rises = _next_rise(session, scout, marks, "sunrise")
        raise UserError(f"the sun is {low} below the horizon{rises}")
    viewport.look_along(sun.direction)


def look_at_moon(session: Session, scout: SunDayFinder, viewport: Viewport) -> None:
    """Turn the camera to the moon.

    Raises:
        UserError: it is below the horizon, or no module has a moon.
    """
    night = session.last(NightLightChanged)
    if night is None:
        raise UserError("there is no moon: no module that runs makes the night")
    moon = night.moon
    if moon is None or moon.place.apparent_elevation_rad < -_RADIUS_RAD:
        marks = {} if scout.moon is None else scout.moon.marks
        rises = _next_rise(session, scout, marks, "moonrise")
        raise UserError(f"the moon is below the horizon{rises}")
    viewport.look_along(moon.place.direction)


def _next_rise(session: Session, scout: SunDayFinder, marks: dict[str, datetime], name: str) -> str:
    """When a body rises later on this day; empty if it does not."""
    clock, when = session.last(ClockMoved), marks.get(name)
    if clock is None or when is None or scout.day is None or when <= clock.instant:
        return ""
    return f": it rises at {when.astimezone(scout.day.zone):%H:%M}"

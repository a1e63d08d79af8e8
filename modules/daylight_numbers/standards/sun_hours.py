"""Hours of sun of a day, by rays towards the sun."""

from datetime import datetime

import numpy as np

from daylight_numbers.matrix.sensors import Sensors, free_sensors
from daylight_numbers.now import sun_shares
from daylight_numbers.rooms import DaylitRoom
from daylight_numbers.work import DaylightWork
from vrut_lite.geometry.frames import world_from_enu
from vrut_lite.messages.place import SetPlace
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.suns import suns_at

STEP_MINUTES = 10
# EN 17037: the reference point lies in an opening, so far above the floor.
_REFERENCE_M = 1.2
# Distance before an opening, in metres, at which rays to the sun begin.
BEFORE_M = 1e-3
_SUN_LEVELS = ((4.0, "high"), (3.0, "medium"), (1.5, "minimum"))


def suns_of_day(place: SetPlace, midnight: datetime) -> FloatArray:
    """Directions (S, 3) of the sun in the middle of the steps of a day in which it is up.

    The sun is that of `vrut_lite.sky.suns` (Michalsky 1988), within 0.02 degrees: no sky is made.
    """
    steps = np.arange(24 * 60 // STEP_MINUTES) + 0.5
    seconds = midnight.timestamp() + 60.0 * STEP_MINUTES * steps
    suns = suns_at(seconds, place.latitude_deg, place.longitude_deg, place.altitude_m)
    up = suns.apparent_elevation_rad > 0.0
    return world_from_enu(suns.east_north_up[up], place.north_offset_rad)


def sun_hours(work: DaylightWork, sensors: Sensors, suns: FloatArray) -> FloatArray:
    """Hours (P,) in which the sun shines on the side that a sensor faces, by `suns_of_day`.

    Sun through glass counts in full, through measured panes where a part of it passes straight.
    """
    shares = sun_shares(work.transport, work.glass, sensors, suns, work.operator.panes)
    seen = shares.any(axis=2)
    return np.asarray(seen.sum(axis=1) * (STEP_MINUTES / 60.0))


def sun_in_openings(work: DaylightWork, room: DaylitRoom, suns: FloatArray) -> float:
    """Most hours of sun at a place in a room's openings, 1.2 m above its floor or higher."""
    most = 0.0
    for opening in room.openings:
        places = opening.places_m - BEFORE_M * opening.outwards
        high = places[:, 1] >= room.box.lower_m[1] + _REFERENCE_M
        places = places[high] if high.any() else places
        sensors = free_sensors(places, np.broadcast_to(opening.outwards, places.shape), "opening")
        most = max(most, float(sun_hours(work, sensors, suns).max()))
    return most


def sun_level(hours: float) -> str:
    """EN 17037's level of so many hours of sun of a day between 1 February and 21 March."""
    return next((said for least, said in _SUN_LEVELS if hours >= least), "none")

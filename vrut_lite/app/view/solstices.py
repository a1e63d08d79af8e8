"""The sun's paths on the longest and the shortest day: all other days lie between them."""

import math

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.frames import world_from_enu
from vrut_lite.messages.place import SetPlace

# The tilt of the Earth's axis in 2026 (IAU 2006: 23.4364 degrees), the sun's declination then.
_TILT_RAD = math.radians(23.436)
_POINTS = 145
SOLSTICES = {"June": _TILT_RAD, "December": -_TILT_RAD}


def sun_circle(place: SetPlace, declination_rad: float) -> NDArray[np.float64]:
    """Geometric directions (n, 3) of a sun of one declination through a day, world axes."""
    latitude = math.radians(place.latitude_deg)
    hour_angle = np.linspace(-np.pi, np.pi, _POINTS)
    flat, high = math.cos(declination_rad), math.sin(declination_rad)
    # To the equator's highest point, to the west and to the pole.
    up_the_meridian, west = flat * np.cos(hour_angle), flat * np.sin(hour_angle)
    north = high * math.cos(latitude) - up_the_meridian * math.sin(latitude)
    up = high * math.sin(latitude) + up_the_meridian * math.cos(latitude)
    return np.asarray(world_from_enu(np.stack([-west, north, up], axis=-1), place.north_offset_rad))

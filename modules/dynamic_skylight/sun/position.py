"""sun_position: from an instant and a place to where the sun stands in the sky."""

import math
from dataclasses import dataclass
from datetime import datetime
from typing import Literal

from dynamic_skylight.sun import ephemeris, preetham
from dynamic_skylight.sun.disc import visible_fraction
from dynamic_skylight.sun.refraction import (
    STANDARD_TEMPERATURE_C,
    pressure_at_altitude_pa,
    refraction_rad,
)
from vrut_lite.geometry.frames import direction_from_angles

Method = Literal["ephemeris", "preetham"]


@dataclass(frozen=True)
class SunPosition:
    """Where the sun's centre stands, seen from a place.

    Attributes:
        elevation_rad: geometric (airless) and topocentric; names the phases of twilight.
        apparent_elevation_rad: lifted by refraction; what light and shadow follow.
        azimuth_rad: from true north, clockwise, in [0, 2 pi).
        direction: unit vector (east, north, up) to the apparent sun.
        visible_disc_fraction: share of the disc above a level horizon, 0 to 1.
    """

    elevation_rad: float
    apparent_elevation_rad: float
    azimuth_rad: float
    direction: tuple[float, float, float]
    visible_disc_fraction: float


def sun_position(
    when: datetime,
    latitude_deg: float,
    longitude_deg: float,
    method: Method = "ephemeris",
    *,
    altitude_m: float = 0.0,
    pressure_pa: float | None = None,
    temperature_c: float = STANDARD_TEMPERATURE_C,
) -> SunPosition:
    """The sun at an instant, seen from a place.

    Args:
        when: an aware datetime, in any time zone.
        latitude_deg: north-positive, -90 to 90, the poles included.
        longitude_deg: east-positive, -180 to 180.
        method: "ephemeris" (within 0.001 deg), or "preetham" (the short series of the
            daylight thesis, corrected; within 1.2 deg).
        altitude_m: above sea level.
        pressure_pa: for refraction; None takes the standard atmosphere's at the altitude.
        temperature_c: for refraction.

    Raises:
        ValueError: for a naive datetime, or a value out of its range, in one sentence.
    """
    _check_instant(when)
    _check_range("latitude", latitude_deg, 90.0)
    _check_range("longitude", longitude_deg, 180.0)
    pressure = pressure_at_altitude_pa(altitude_m) if pressure_pa is None else pressure_pa
    _check_air(altitude_m, pressure, temperature_c)
    azimuth, elevation = _geometric_angles(when, latitude_deg, longitude_deg, altitude_m, method)
    apparent = elevation + float(refraction_rad(elevation, pressure, temperature_c))
    east, north, up = (float(v) for v in direction_from_angles(azimuth, apparent))
    return SunPosition(
        elevation_rad=elevation,
        apparent_elevation_rad=apparent,
        azimuth_rad=azimuth,
        direction=(east, north, up),
        visible_disc_fraction=float(visible_fraction(apparent)),
    )


def _geometric_angles(
    when: datetime, latitude_deg: float, longitude_deg: float, altitude_m: float, method: Method
) -> tuple[float, float]:
    if method == "ephemeris":
        return ephemeris.geometric_angles(when, latitude_deg, longitude_deg, altitude_m)
    if method == "preetham":
        return preetham.geometric_angles(when, latitude_deg, longitude_deg)
    raise ValueError(f"the method must be 'ephemeris' or 'preetham', not {method!r}")


def _check_instant(when: datetime) -> None:
    if when.utcoffset() is None:
        raise ValueError(
            f"the instant {when} has no time zone: give an aware datetime, such as one in UTC"
        )


def _check_range(name: str, value_deg: float, limit_deg: float) -> None:
    # Written so that a NaN is refused too.
    if not -limit_deg <= value_deg <= limit_deg:
        raise ValueError(
            f"the {name} must lie between -{limit_deg:g} and {limit_deg:g} deg, not {value_deg}"
        )


def _check_air(altitude_m: float, pressure_pa: float, temperature_c: float) -> None:
    if not math.isfinite(altitude_m):
        raise ValueError(f"the altitude must be a finite number of metres, not {altitude_m}")
    if not 0.0 <= pressure_pa < math.inf:
        raise ValueError(f"the pressure must be 0 Pa or more, not {pressure_pa}")
    if not -273.0 < temperature_c < math.inf:
        raise ValueError(f"the temperature must lie above -273 deg C, not {temperature_c}")

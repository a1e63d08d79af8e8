"""sun_position: the sun's position in the sky for an instant and a place."""

from dataclasses import dataclass
from datetime import datetime
from typing import Literal, get_args

from dynamic_skylight.sun import ephemeris, preetham
from vrut_lite.arguments import as_number, check_choice, check_instant
from vrut_lite.atmosphere.refraction import (
    STANDARD_TEMPERATURE_C,
    pressure_at_altitude_pa,
    refraction_of_true_rad,
)
from vrut_lite.geometry.frames import direction_from_angles
from vrut_lite.messages.place import HIGHEST_M, LOWEST_M
from vrut_lite.sky.visible_disc import visible_fraction

Method = Literal["ephemeris", "preetham"]
# The standard atmosphere has 325,000 Pa at the lowest altitude.
_HIGHEST_PA = 400_000.0
_TEMPERATURES_C = (-150.0, 100.0)


@dataclass(frozen=True)
class SunPosition:
    """The position of the sun's centre, seen from a place.

    Attributes:
        elevation_rad: geometric (airless) and topocentric; defines the phases of twilight.
        apparent_elevation_rad: raised by refraction; light and shadow follow it.
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
        when: an aware datetime, in any time zone, of the years 1600 to 2600.
        latitude_deg: north-positive, -90 to 90, the poles included.
        longitude_deg: east-positive, -180 to 180.
        method: "ephemeris" (within 0.001 deg), or "preetham" (the short series of the
            daylight thesis, corrected; within 1.2 deg).
        altitude_m: above sea level, -11,000 to 36,000,000.
        pressure_pa: for refraction, 0 to 400,000; None: the standard atmosphere's at the
            altitude.
        temperature_c: for refraction, -150 to 100.

    Raises:
        ValueError: for a naive datetime, or a value out of its range, in one sentence.
    """
    check_instant("when", when)
    latitude_deg, longitude_deg, altitude_m = checked_place(latitude_deg, longitude_deg, altitude_m)
    check_choice("method", method, get_args(Method))
    pressure = None
    if pressure_pa is not None:
        pressure = as_number("pressure_pa", pressure_pa, 0.0, _HIGHEST_PA, "Pa")
    celsius = as_number("temperature_c", temperature_c, *_TEMPERATURES_C, "deg C")
    return position_at(when, latitude_deg, longitude_deg, method, altitude_m, pressure, celsius)


def checked_place(
    latitude_deg: float, longitude_deg: float, altitude_m: float
) -> tuple[float, float, float]:
    """The place; ValueError if one of its numbers is out of its range."""
    return (
        as_number("latitude_deg", latitude_deg, -90.0, 90.0, "deg"),
        as_number("longitude_deg", longitude_deg, -180.0, 180.0, "deg"),
        as_number("altitude_m", altitude_m, LOWEST_M, HIGHEST_M, "m"),
    )


def position_at(
    when: datetime,
    latitude_deg: float,
    longitude_deg: float,
    method: Method,
    altitude_m: float,
    pressure_pa: float | None = None,
    temperature_c: float = STANDARD_TEMPERATURE_C,
) -> SunPosition:
    """`sun_position` of checked arguments."""
    pressure = pressure_at_altitude_pa(altitude_m) if pressure_pa is None else pressure_pa
    azimuth, elevation = _geometric_angles(when, latitude_deg, longitude_deg, altitude_m, method)
    apparent = elevation + float(refraction_of_true_rad(elevation, pressure, temperature_c))
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
    return preetham.geometric_angles(when, latitude_deg, longitude_deg)

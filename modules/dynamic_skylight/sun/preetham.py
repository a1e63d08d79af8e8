"""The sun by the short series of Preetham et al. 1999, corrected.

As the daylight thesis prints them (Hvezda 2020, equations 3.1 to 3.3) the formulas fail in
two ways. The azimuth's arctan loses the quadrant, and with atan2 instead its denominator
cos X sin d - sin X cos d cos a still has the wrong sign: against NREL SPA it errs 16 deg in
the median and 75 deg at worst. And the longitude term 12 (SM - X_lambda) / pi reckons
longitudes west-positive on a clock of zone time. With a clock in UTC and east-positive
longitude it is +12 longitude / pi. What is left, 0.2 deg in the median and 1.1 deg at worst,
is the shortness of the series for declination and equation of time.

The day of the year here carries its fraction, so that nothing jumps at midnight UTC.
"""

import math
from datetime import UTC, datetime

from vrut_lite.geometry.frames import angles_from_direction


def geometric_angles(
    when: datetime, latitude_deg: float, longitude_deg: float
) -> tuple[float, float]:
    """Azimuth (from north, clockwise) and geometric elevation, in radians."""
    utc = when.astimezone(UTC)
    hours = utc.hour + utc.minute / 60 + (utc.second + utc.microsecond * 1e-6) / 3600
    day = utc.timetuple().tm_yday + hours / 24
    declination = 0.4093 * math.sin(2 * math.pi * (day - 81) / 368)
    longitude = math.radians(longitude_deg)
    solar_hours = hours + _equation_of_time(day) + 12 * longitude / math.pi
    direction = _direction(math.radians(latitude_deg), declination, math.pi * solar_hours / 12)
    azimuth, elevation = angles_from_direction(direction)
    return float(azimuth), float(elevation)


def _equation_of_time(day: float) -> float:
    """True minus mean solar time, in hours."""
    return 0.170 * math.sin(4 * math.pi * (day - 80) / 373) - 0.129 * math.sin(
        2 * math.pi * (day - 8) / 355
    )


def _direction(latitude: float, declination: float, a: float) -> tuple[float, float, float]:
    """East, north, up; a is the angle of solar time, 0 at midnight.

    As a vector rather than arcsin and a quotient: exact at the zenith and at the poles.
    """
    sin_x, cos_x = math.sin(latitude), math.cos(latitude)
    sin_d, cos_d = math.sin(declination), math.cos(declination)
    return (
        cos_d * math.sin(a),
        cos_x * sin_d + sin_x * cos_d * math.cos(a),
        sin_x * sin_d - cos_x * cos_d * math.cos(a),
    )

"""The sun's direction at many instants at once: the Astronomical Almanac's short formula.

Within 0.02 degrees from 1950 to 2050 (J. J. Michalsky 1988, Solar Energy 40, 227).
"""

from datetime import UTC, datetime
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.messages.weather import LEAP_HOURS, SetWeather
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.visible_disc import visible_fraction

_J2000 = 946_728_000.0
_HOUR_S = 3600.0


class Suns(NamedTuple):
    """Angles (...,) in radians: geometric and apparent elevation, azimuth from north clockwise."""

    elevation_rad: FloatArray
    apparent_elevation_rad: FloatArray
    azimuth_rad: FloatArray

    @property
    def disc_fraction(self) -> FloatArray:
        """Visible share (...,) of the disc."""
        return visible_fraction(self.apparent_elevation_rad)

    @property
    def east_north_up(self) -> FloatArray:
        """Unit vectors (..., 3) to the apparent sun."""
        level = np.cos(self.apparent_elevation_rad)
        east, north = level * np.sin(self.azimuth_rad), level * np.cos(self.azimuth_rad)
        return np.stack([east, north, np.sin(self.apparent_elevation_rad)], axis=-1)


def suns_at(
    seconds: ArrayLike, latitude_deg: float, longitude_deg: float, altitude_m: float = 0.0
) -> Suns:
    """The suns at seconds (...,) since 1970 UTC."""
    seconds = np.asarray(seconds, dtype=float)
    days = (seconds - _J2000) / 86_400.0
    anomaly = np.radians(357.528 + 0.9856003 * days)
    longitude = np.radians(
        280.460 + 0.9856474 * days + 1.915 * np.sin(anomaly) + 0.020 * np.sin(2.0 * anomaly)
    )
    tilt = np.radians(23.439 - 4e-7 * days)
    ascension = np.arctan2(np.cos(tilt) * np.sin(longitude), np.cos(longitude))
    declination = np.arcsin(np.sin(tilt) * np.sin(longitude))
    sidereal_deg = 280.46062 + 360.98564737 * days
    hour_angle = np.radians(sidereal_deg + longitude_deg) - ascension
    latitude = np.radians(latitude_deg)
    up = np.sin(latitude) * np.sin(declination)
    up = up + np.cos(latitude) * np.cos(declination) * np.cos(hour_angle)
    north = np.cos(latitude) * np.sin(declination)
    north = north - np.sin(latitude) * np.cos(declination) * np.cos(hour_angle)
    east = -np.cos(declination) * np.sin(hour_angle)
    elevation = np.arcsin(np.clip(up, -1.0, 1.0))
    azimuth = np.arctan2(east, north) % (2.0 * np.pi)
    return Suns(elevation, elevation + _refraction_rad(elevation, altitude_m), azimuth)


def _refraction_rad(elevation_rad: FloatArray, altitude_m: float) -> FloatArray:
    """Saemundsson 1986 in standard air; held below -1 degree, gone at -6."""
    degrees = np.degrees(elevation_rad)
    held = np.maximum(degrees, -1.0)
    arcminutes = np.maximum(1.02 / np.tan(np.radians(held + 10.3 / (held + 5.11))), 0.0)
    fade = np.clip((degrees + 6.0) / 5.0, 0.0, 1.0)
    return np.radians(arcminutes * fade / 60.0) * np.exp(-max(altitude_m, 0.0) / 8430.0)


def middle_of_sunlit(
    start_s: ArrayLike, latitude_deg: float, longitude_deg: float, altitude_m: float = 0.0
) -> FloatArray:
    """Seconds (...,) of the middle of the sunlit part of the hours that begin at `start_s`.

    The middle of the hour where the sun does not cross the horizon.
    """
    start = np.asarray(start_s, dtype=float)

    def up(share: ArrayLike) -> FloatArray:
        at = start + _HOUR_S * np.asarray(share)
        return suns_at(at, latitude_deg, longitude_deg, altitude_m).apparent_elevation_rad

    first, last = up(0.0), up(1.0)
    crosses: NDArray[np.bool_] = (first > 0.0) != (last > 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(crosses, first / (first - last), 0.5)
        # A step of regula falsi: the path bends little within an hour.
        height = up(share)
        rising = last > 0.0
        step = np.where(
            rising == (height > 0.0), share * height / (first - height),
            (1.0 - share) * height / (height - last),
        )  # fmt: skip
    share = np.clip(np.where(crosses, share + np.nan_to_num(step), 0.5), 0.0, 1.0)
    middle = np.where(crosses, np.where(rising, 0.5 + 0.5 * share, 0.5 * share), 0.5)
    return np.asarray(start + _HOUR_S * middle)


def hour_edges_s(hours: int, utc_offset_h: float) -> FloatArray:
    """Seconds (hours + 1,) since 1970 of the hours' ends, in 2023 or the leap year 2024."""
    first = datetime(2024 if hours == LEAP_HOURS else 2023, 1, 1, tzinfo=UTC).timestamp()
    return np.asarray(first + _HOUR_S * (np.arange(hours + 1) - utc_offset_h))


def suns_of_year(weather: SetWeather) -> Suns:
    """The suns (hours,) of the middle of each hour's sunlit part, of 2023 or the leap year 2024."""
    starts = hour_edges_s(len(weather.direct_normal_w_m2), weather.utc_offset_h)[:-1]
    where = weather.latitude_deg, weather.longitude_deg, weather.altitude_m
    return suns_at(middle_of_sunlit(starts, *where), *where)

"""The sun's position by the PSA algorithm, as in the published evaluation.

Blanco-Muriel, Alarcon-Padilla, Lopez-Moratalla and Lara-Coira 2001, "Computing the solar
vector", Solar Energy 70. Used here for likeness with the published evaluation; the project's
own `dynamic_skylight.sun_position` is more exact (the two differ by less than 0.01 deg).
"""

from datetime import UTC, datetime

import numpy as np

_J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
_PARALLAX = 6371.01 / 149_597_890.0


def sun_coordinates(
    when: datetime, latitude_deg: float, longitude_deg: float
) -> tuple[float, float]:
    """Zenith angle and azimuth in rad, the azimuth from north, clockwise, in [0, 2 pi).

    Args:
        when: an aware datetime.
        latitude_deg: north-positive.
        longitude_deg: east-positive.
    """
    universal = when.astimezone(UTC)
    midnight = universal.replace(hour=0, minute=0, second=0, microsecond=0)
    hours = (universal - midnight).total_seconds() / 3600.0
    days = (universal - _J2000).total_seconds() / 86_400.0
    right_ascension, declination = _equatorial(days)
    sidereal_h = 6.6974243242 + 0.0657098283 * days + hours
    hour_angle = np.radians(15.0 * sidereal_h + longitude_deg) - right_ascension
    return _horizontal(float(hour_angle), declination, float(np.radians(latitude_deg)))


def _equatorial(days: float) -> tuple[float, float]:
    """Right ascension and declination in rad, days after noon of 1 January 2000."""
    omega = 2.1429 - 0.0010394594 * days
    mean_longitude = 4.8950630 + 0.017202791698 * days
    anomaly = 6.2400600 + 0.0172019699 * days
    longitude = (
        mean_longitude
        + 0.03341607 * np.sin(anomaly)
        + 0.00034894 * np.sin(2.0 * anomaly)
        - 0.0001134
        - 0.0000203 * np.sin(omega)
    )
    obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * np.cos(omega)
    sine = np.sin(longitude)
    right_ascension = np.arctan2(np.cos(obliquity) * sine, np.cos(longitude))
    return float(right_ascension), float(np.arcsin(np.sin(obliquity) * sine))


def _horizontal(hour_angle: float, declination: float, latitude: float) -> tuple[float, float]:
    cos_zenith = np.cos(latitude) * np.cos(hour_angle) * np.cos(declination)
    zenith = float(np.arccos(cos_zenith + np.sin(declination) * np.sin(latitude)))
    northward = np.tan(declination) * np.cos(latitude) - np.sin(latitude) * np.cos(hour_angle)
    azimuth = np.mod(np.arctan2(-np.sin(hour_angle), northward), 2.0 * np.pi)
    # Seen from the ground and not from the Earth's centre, the sun is a little lower.
    return zenith + _PARALLAX * float(np.sin(zenith)), float(azimuth)

"""The ephemeris' sun at many instants and places at once.

astronomy-engine computes one instant and one place a call. Its geocentric sun and its sidereal
time are sampled twice a day and interpolated; topocentric angles follow by array operations. They
differ from the ephemeris by less than 1e-7 degrees.
"""

import astronomy
import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.atmosphere.refraction import pressure_at_altitude_pa, refraction_of_true_rad
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.suns import Suns

_J2000_S, _DAY_S = 946_728_000.0, 86_400.0
# Spacing of the interpolation's nodes (days).
_NODE_DAYS = 0.5
# Earth rotation angle at J2000 (degrees) and its rate (degrees a day of UT1); IERS conventions.
_ROTATION_DEG, _ROTATION_DEG_PER_DAY = 280.46061837, 360.98564736629
# Ellipsoid of astronomy-engine: equatorial radius (km), polar over equatorial radius.
_EQUATOR_KM, _POLAR_RATIO = 6378.1366, 0.996647180302104
_AU_KM = 1.4959787069098932e8


class SunTrack:
    """The apparent sun between two instants, in seconds since 1970 UTC.

    Refraction is that of the standard atmosphere at the altitude.
    """

    def __init__(self, start_s: float, end_s: float):
        first = np.floor((start_s - _J2000_S) / _DAY_S / _NODE_DAYS) - 1.0
        last = np.floor((end_s - _J2000_S) / _DAY_S / _NODE_DAYS) + 3.0
        days = np.arange(first, last) * _NODE_DAYS
        self._first = first
        self._nodes = np.array([_node(float(day)) for day in days])

    def earth_fixed_au(self, seconds: ArrayLike) -> FloatArray:
        """Vectors (..., 3) from the Earth's centre to the sun, AU.

        +X points to 0 N 0 E, +Z to the north pole.
        """
        days = (np.asarray(seconds, dtype=float) - _J2000_S) / _DAY_S
        place = days / _NODE_DAYS - self._first
        index = np.clip(np.floor(place).astype(int), 1, len(self._nodes) - 3)
        u = (place - index)[..., None]
        # Cubic of Lagrange through the nodes at -1, 0, 1 and 2.
        x, y, z, excess = np.moveaxis(
            -u * (u - 1.0) * (u - 2.0) / 6.0 * self._nodes[index - 1]
            + (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0 * self._nodes[index]
            - (u + 1.0) * u * (u - 2.0) / 2.0 * self._nodes[index + 1]
            + (u + 1.0) * u * (u - 1.0) / 6.0 * self._nodes[index + 2],
            -1,
            0,
        )
        turn = np.radians(_ROTATION_DEG + _ROTATION_DEG_PER_DAY * days + excess)
        c, s = np.cos(turn), np.sin(turn)
        return np.stack([c * x + s * y, c * y - s * x, z], axis=-1)

    def suns(
        self,
        seconds: ArrayLike,
        latitude_deg: ArrayLike,
        longitude_deg: ArrayLike,
        altitude_m: float = 0.0,
    ) -> Suns:
        """Topocentric angles (...,) of instants and places, which broadcast."""
        latitude, longitude = np.radians(latitude_deg), np.radians(longitude_deg)
        up, east, north = _axes(latitude, longitude)
        sun = self.earth_fixed_au(seconds) - _observer_au(latitude, longitude, altitude_m)
        upwards, eastwards, northwards = (
            np.einsum("...i,...i->...", sun, axis) for axis in (up, east, north)
        )
        elevation = np.arctan2(upwards, np.hypot(eastwards, northwards))
        raised = refraction_of_true_rad(elevation, pressure_at_altitude_pa(altitude_m))
        azimuth = np.arctan2(eastwards, northwards) % (2.0 * np.pi)
        return Suns(elevation, elevation + raised, azimuth)


def _node(days: float) -> tuple[float, float, float, float]:
    """The sun's vector, equator and equinox of date, AU; sidereal time beyond its mean rate, deg.

    `days` count from J2000, UT1.
    """
    time = astronomy.Time(days)
    of_j2000 = astronomy.GeoVector(astronomy.Body.Sun, time, True)
    sun = astronomy.RotateVector(astronomy.Rotation_EQJ_EQD(time), of_j2000)
    sidereal_deg = 15.0 * astronomy.SiderealTime(time)
    excess = sidereal_deg - (_ROTATION_DEG + _ROTATION_DEG_PER_DAY * days)
    return sun.x, sun.y, sun.z, (excess + 180.0) % 360.0 - 180.0


def _axes(latitude: FloatArray, longitude: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit vectors (..., 3) up, east and north of geodetic places, Earth-fixed."""
    c, s = np.cos(latitude), np.sin(latitude)
    cl, sl = np.cos(longitude), np.sin(longitude)
    up = np.stack(np.broadcast_arrays(c * cl, c * sl, s), axis=-1)
    east = np.stack(np.broadcast_arrays(-sl, cl, 0.0 * s), axis=-1)
    north = np.stack(np.broadcast_arrays(-s * cl, -s * sl, c), axis=-1)
    return up, east, north


def _observer_au(latitude: FloatArray, longitude: FloatArray, altitude_m: float) -> FloatArray:
    """Vectors (..., 3) from the Earth's centre to places on the ellipsoid, AU, Earth-fixed."""
    c, s = np.cos(latitude), np.sin(latitude)
    across = 1.0 / np.hypot(c, _POLAR_RATIO * s)
    level = (_EQUATOR_KM * across + altitude_m / 1000.0) * c
    axial = (_EQUATOR_KM * _POLAR_RATIO**2 * across + altitude_m / 1000.0) * s
    parts = level * np.cos(longitude), level * np.sin(longitude), axial
    return np.stack(np.broadcast_arrays(*parts), axis=-1) / _AU_KM

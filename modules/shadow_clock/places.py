"""Where on Earth a shadow falls so at an instant: a circle around the point below the sun."""

from copy import copy
from dataclasses import dataclass
from datetime import datetime
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from shadow_clock.crossings import crossings
from shadow_clock.measured_shadow import MeasuredShadow
from vrut_lite.atmosphere.planet import EARTH_RADIUS_M
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.sun_track import SunTrack
from vrut_lite.sky.suns import Suns

# Directions from the point below the sun in which the circle is sampled.
_DIRECTIONS = 1440
# Circles within the band, and instants within the error of time, from which a place's error comes.
_CIRCLES, _INSTANTS = 9, 5
# Steps towards the true radius of a circle, each of which gains 0.7 of a digit or more.
_STEPS = 20
_EARTH_KM = EARTH_RADIUS_M / 1000.0


class EarthLine(NamedTuple):
    """Places (n,) along a line on Earth, degrees; a circle ends where it begins."""

    latitude_deg: FloatArray
    longitude_deg: FloatArray


@dataclass(frozen=True)
class ShadowPlace:
    """A place on the line at which the bearing fits.

    Attributes:
        latitude_deg, longitude_deg: where bearing and ratio fit best.
        error_km: distance of the farthest place that fits the errors and is nearer to this one than
            to another.
        bearing_deg: of the shadow there.
    """

    latitude_deg: float
    longitude_deg: float
    error_km: float
    bearing_deg: float


class ShadowCircle:
    """The places where a shadow has its length ratio at an instant."""

    def __init__(self, shadow: MeasuredShadow, instant: datetime, time_error_s: float = 0.0):
        """Find the sun of the instant; a bearing of the shadow counts in `places` alone."""
        self.shadow, self._time_error_s = shadow, time_error_s
        self._at_s = instant.timestamp()
        self._track = SunTrack(self._at_s - time_error_s, self._at_s + time_error_s)

    def with_shadow(self, shadow: MeasuredShadow) -> "ShadowCircle":
        """The same instant for another shadow."""
        other = copy(self)
        other.shadow = shadow
        return other

    @property
    def below_sun(self) -> tuple[float, float]:
        """Latitude and longitude in degrees of the place where the sun stands in the zenith."""
        line = self._circle(0.5 * np.pi, np.zeros(1), self._at_s)
        return float(line.latitude_deg[0]), float(line.longitude_deg[0])

    def line(self) -> EarthLine:
        """The circle of the measured ratio."""
        return self._circle(self.shadow.elevation_rad, _turn(), self._at_s)

    def edges(self) -> list[EarthLine]:
        """The circles of the longest and the shortest shadow that fit, at the earliest and latest
        instant."""
        offsets = np.unique([-self._time_error_s, self._time_error_s])
        return [
            self._circle(elevation, _turn(), self._at_s + offset)
            for offset in offsets
            for elevation in self.shadow.elevations_rad
        ]

    def radii_km(self) -> tuple[float, float, float]:
        """Great-circle distances from the point below the sun, without the error of time.

        To the line, and to the edges of the shortest and the longest shadow that fit.
        """
        low, high = self.shadow.elevations_rad
        below = EarthLine(*(np.array([value]) for value in self.below_sun))
        lines = [
            self._circle(elevation, np.zeros(1), self._at_s)
            for elevation in (self.shadow.elevation_rad, high, low)
        ]
        middle, near, far = (float(_distance_km(line, below)[0, 0]) for line in lines)
        return middle, near, far

    def misfit(self, latitude_deg: FloatArray, longitude_deg: FloatArray) -> FloatArray:
        """Misfit (...,) of places, the least within the error of time: fits up to 1."""
        found = [
            np.max(self.shadow.misfits(self._suns(latitude_deg, longitude_deg, at)), axis=0)
            for at in self._instants()
        ]
        return np.min(found, axis=0)

    def places(self) -> list[ShadowPlace]:
        """The places on the line with the measured bearing; of each stretch that only fits within
        the error, the best."""
        turns = _turn()
        found = crossings(lambda turn: self.shadow.across(self._on_line(turn)), turns)
        found = found[self.shadow.points_along(self._on_line(found))]
        found = found[found < 2.0 * np.pi]
        if not found.size:
            found = self._nearest(turns)
        if not found.size:
            return []
        line = self._circle(self.shadow.elevation_rad, found, self._at_s)
        suns = self._suns(*line, self._at_s)
        bearings = (np.degrees(suns.azimuth_rad) + 180.0) % 360.0
        errors = self._errors_km(line)
        return [ShadowPlace(*map(float, row)) for row in zip(*line, errors, bearings, strict=True)]

    def _nearest(self, turns: FloatArray) -> FloatArray:
        """The direction (1,) of the place on the line whose bearing fits best; empty if none."""
        misfit = self.shadow.bearing_misfit(self._on_line(turns))
        best = int(np.argmin(misfit))
        return turns[[best]] if misfit[best] <= 1.0 else turns[:0]

    def _errors_km(self, found: EarthLine) -> FloatArray:
        """The error (k,) of places (k,), by all places that fit."""
        low, high = self.shadow.elevations_rad
        away = np.zeros(len(found.latitude_deg))
        for at in self._instants():
            for elevation in np.linspace(low, high, _CIRCLES):
                line = self._circle(float(elevation), _turn(), at)
                fits = self.shadow.bearing_misfit(self._suns(*line, at)) <= 1.0
                distance = _distance_km(line, found)[fits]
                nearest = np.argmin(distance, axis=1)
                for number in range(len(away)):
                    mine = distance[nearest == number, number]
                    away[number] = max(away[number], mine.max(initial=0.0))
        return away

    def _instants(self) -> FloatArray:
        if self._time_error_s == 0.0:
            return np.array([self._at_s])
        return self._at_s + np.linspace(-self._time_error_s, self._time_error_s, _INSTANTS)

    def _on_line(self, turn: FloatArray) -> Suns:
        return self._suns(*self._circle(self.shadow.elevation_rad, turn, self._at_s), self._at_s)

    def _suns(self, latitude_deg: ArrayLike, longitude_deg: ArrayLike, at_s: float) -> Suns:
        return self._track.suns(at_s, latitude_deg, longitude_deg)

    def _circle(self, elevation_rad: float, turn: FloatArray, at_s: float) -> EarthLine:
        """Places with the sun at an apparent elevation, in directions (n,) from below the sun.

        Directions run clockwise from north. Geodetic normals towards the sun's geocentric direction
        begin it; refraction and parallax follow by fixed-point steps.
        """
        sun = self._track.earth_fixed_au(at_s)
        sun = sun / np.linalg.norm(sun)
        north = np.array([0.0, 0.0, 1.0]) - sun[2] * sun
        north /= np.linalg.norm(north)
        aside = np.cos(turn)[:, None] * north + np.sin(turn)[:, None] * np.cross(north, sun)
        radius = np.full(turn.shape, 0.5 * np.pi - elevation_rad)
        for _ in range(_STEPS):
            normal = np.cos(radius)[:, None] * sun + np.sin(radius)[:, None] * aside
            line = EarthLine(
                np.degrees(np.arctan2(normal[:, 2], np.hypot(normal[:, 0], normal[:, 1]))),
                np.degrees(np.arctan2(normal[:, 1], normal[:, 0])),
            )
            seen = self._suns(*line, at_s).apparent_elevation_rad
            radius = np.maximum(radius + seen - elevation_rad, 0.0)
        return line


def _turn() -> FloatArray:
    return np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS + 1)


def _distance_km(line: EarthLine, other: EarthLine) -> FloatArray:
    """Great-circle distances (n, k) of places (n,) from others (k,), km."""
    latitude, longitude = (np.radians(part)[:, None] for part in line)
    latitudes, longitudes = (np.radians(part)[None] for part in other)
    half = np.sin(0.5 * (latitude - latitudes)) ** 2
    half = half + np.cos(latitude) * np.cos(latitudes) * np.sin(0.5 * (longitude - longitudes)) ** 2
    return np.asarray(2.0 * _EARTH_KM * np.arcsin(np.sqrt(np.minimum(half, 1.0))))

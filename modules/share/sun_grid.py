"""Places of the sun and the moon for which light is computed, and interpolation between them.

Nodes lie at even hour angles and declinations, so that a day runs along a row of them. Hour angles
count from south (north of it: from the meridian) westwards, in [0, 2 pi). The twin is
`page/src/light.js`.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from share.shared_scene import SUN_GONE_RAD
from vrut_lite.atmosphere.refraction import refraction_of_true_rad
from vrut_lite.numeric_types import FloatArray

# The moon's greatest declination is 28.7 degrees.
_MOST_DECLINATION_RAD = float(np.radians(28.8))


@dataclass(frozen=True)
class SunGrid:
    """Nodes (declinations, hours) over a place.

    `north_offset_rad` is the azimuth of the world's -Z from north.
    """

    latitude_rad: float
    north_offset_rad: float
    declinations: int
    hours: int

    @cached_property
    def declination_rad(self) -> FloatArray:
        """Declinations (declinations,) of the nodes."""
        return np.linspace(-_MOST_DECLINATION_RAD, _MOST_DECLINATION_RAD, self.declinations)

    @cached_property
    def hour_rad(self) -> FloatArray:
        """Hour angles (hours,) of the nodes."""
        return 2.0 * np.pi * np.arange(self.hours) / self.hours

    @cached_property
    def heights(self) -> FloatArray:
        """Geometric elevation (declinations, hours) of the nodes."""
        return self._angles[0]

    @cached_property
    def azimuths(self) -> FloatArray:
        """Azimuth (declinations, hours) from the world's -Z, clockwise from above."""
        return self._angles[1] - self.north_offset_rad

    @cached_property
    def _angles(self) -> tuple[FloatArray, FloatArray]:
        declination, hour = np.meshgrid(self.declination_rad, self.hour_rad, indexing="ij")
        return horizontal(declination, hour, self.latitude_rad)

    @cached_property
    def lit(self) -> np.ndarray:
        """Numbers (n,) of the nodes, row after row, at which there is light."""
        return np.flatnonzero(self.heights.ravel() > SUN_GONE_RAD)

    @cached_property
    def sources(self) -> np.ndarray:
        """Number of the lit node whose light each node (declinations, hours) has.

        Dark nodes repeat a neighbour's: light there is negligible, but interpolation beside it must
        not fade early.
        """
        row, hour = np.divmod(np.arange(self.declinations * self.hours), self.hours)
        apart = np.abs(hour[:, None] - hour[self.lit])
        apart = np.minimum(apart, self.hours - apart)
        cost = apart + 100 * np.abs(row[:, None] - row[self.lit])
        return cost.argmin(axis=1).reshape(self.declinations, self.hours)

    def filled(self, values: FloatArray) -> FloatArray:
        """Values (declinations, hours, ...) of lit nodes' (n, ...)."""
        return np.asarray(values[self.sources])

    def weights(self, declination_rad: float, hour_rad: float) -> list[tuple[int, int, float]]:
        """Rows, columns and weights of the nodes about a place; cubic along the hours."""
        step = self.declination_rad[1] - self.declination_rad[0]
        v = np.clip((declination_rad - self.declination_rad[0]) / step, 0.0, self.declinations - 1)
        u = (hour_rad % (2.0 * np.pi)) / (2.0 * np.pi) * self.hours
        row, column = min(int(v), self.declinations - 2), int(u)
        along, across = cubic(u - column), (1.0 - (v - row), v - row)
        return [
            (row + j, (column + i - 1) % self.hours, across[j] * along[i])
            for j in range(2)
            for i in range(4)
        ]


def cubic(t: float) -> tuple[float, float, float, float]:
    """Weights of four even nodes at t in [0, 1] between the second and the third.

    Catmull and Rom 1974 ("A class of local interpolating splines").
    """
    return (
        0.5 * t * (t * (2.0 - t) - 1.0),
        0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
        0.5 * t * (t * (4.0 - 3.0 * t) + 1.0),
        0.5 * t * t * (t - 1.0),
    )


def horizontal(
    declination_rad: FloatArray, hour_rad: FloatArray, latitude_rad: float
) -> tuple[FloatArray, FloatArray]:
    """Geometric elevation and azimuth from north, clockwise."""
    sine = np.sin(latitude_rad) * np.sin(declination_rad)
    sine = sine + np.cos(latitude_rad) * np.cos(declination_rad) * np.cos(hour_rad)
    east = -np.cos(declination_rad) * np.sin(hour_rad)
    north = np.cos(latitude_rad) * np.sin(declination_rad)
    north = north - np.sin(latitude_rad) * np.cos(declination_rad) * np.cos(hour_rad)
    return np.arcsin(np.clip(sine, -1.0, 1.0)), np.arctan2(east, north)


def equatorial(
    elevation_rad: float, azimuth_rad: float, latitude_rad: float
) -> tuple[float, float]:
    """Declination and hour angle of a geometric elevation and an azimuth from north."""
    sine = np.sin(latitude_rad) * np.sin(elevation_rad)
    sine += np.cos(latitude_rad) * np.cos(elevation_rad) * np.cos(azimuth_rad)
    west = -np.cos(elevation_rad) * np.sin(azimuth_rad)
    south = np.cos(latitude_rad) * np.sin(elevation_rad)
    south -= np.sin(latitude_rad) * np.cos(elevation_rad) * np.cos(azimuth_rad)
    return float(np.arcsin(np.clip(sine, -1.0, 1.0))), float(np.arctan2(west, south))


def apparent(true_rad: float, pressure_pa: float) -> float:
    """Apparent elevation of a geometric one."""
    return true_rad + float(refraction_of_true_rad(true_rad, pressure_pa))

"""Places of the sun and the moon for which light is computed, and interpolation between them.

By day they lie at even hour angles and declinations, so that a day runs along a row of them; by
dusk at steps of height and even azimuths. The two are kept apart: where the sun has set no sunlit
wall lights the others, and light changes within a degree. The twin is `page/src/light.js`.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vrut_lite.atmosphere.refraction import refraction_of_true_rad
from vrut_lite.numeric_types import FloatArray

# The sun's declination stays within; the moon's, of up to 28.7 degrees, is held.
MOST_DECLINATION_RAD = float(np.radians(24.0))
# Geometric elevations of dusk's places, rising: from where the sun's light is gone.
DUSK_RAD = np.radians([-19.0, -15.5, -12.0, -9.0, -6.5, -4.0, -2.0, -0.7])
# Geometric elevation from which places of the day are computed, and heights between which they
# take over from dusk's.
_DAY_RAD = float(np.radians(0.3))
TAKES_OVER_RAD = (float(np.radians(-0.85)), float(np.radians(0.3)))


@dataclass(frozen=True)
class SunPlaces:
    """Places (N) above a location: those of the day, then those of dusk, row by row.

    `north_offset_rad` is the azimuth of the world's -Z from north.
    """

    latitude_rad: float
    north_offset_rad: float
    declinations: int = 9
    hours: int = 72
    dusk_azimuths: int = 20

    @cached_property
    def heights(self) -> FloatArray:
        """Geometric elevations (N,)."""
        return self._angles[0]

    @cached_property
    def azimuths(self) -> FloatArray:
        """Azimuths (N,) from the world's -Z, clockwise from above."""
        return self._angles[1] - self.north_offset_rad

    @cached_property
    def _day(self) -> tuple[FloatArray, FloatArray]:
        """Elevation and azimuth from north (declinations, hours)."""
        declination = np.linspace(-MOST_DECLINATION_RAD, MOST_DECLINATION_RAD, self.declinations)
        hour = 2.0 * np.pi * np.arange(self.hours) / self.hours
        return horizontal(*np.meshgrid(declination, hour, indexing="ij"), self.latitude_rad)

    @cached_property
    def _lit(self) -> NDArray[np.int64]:
        """Numbers of the day's nodes that are computed; at least one."""
        heights = self._day[0].ravel()
        found = np.flatnonzero(heights > _DAY_RAD)
        return found if len(found) else np.array([int(heights.argmax())])

    @cached_property
    def _angles(self) -> tuple[FloatArray, FloatArray]:
        turn = 2.0 * np.pi * np.arange(self.dusk_azimuths) / self.dusk_azimuths
        height, azimuth = (part.ravel()[self._lit] for part in self._day)
        dusk = np.meshgrid(DUSK_RAD, turn, indexing="ij")
        return (
            np.concatenate([height, dusk[0].ravel()]),
            np.concatenate([azimuth, dusk[1].ravel()]),
        )

    @property
    def first_of_dusk(self) -> int:
        """Number of dusk's first place."""
        return len(self._lit)

    @cached_property
    def day_nodes(self) -> NDArray[np.int64]:
        """Place whose light each of the day's nodes (declinations, hours) has.

        Nodes below the horizon repeat the nearest one of their row, or of the nearest row.
        """
        row, hour = np.divmod(np.arange(self.declinations * self.hours), self.hours)
        apart = np.abs(hour[:, None] - hour[self._lit])
        apart = np.minimum(apart, self.hours - apart)
        cost = apart + 100 * np.abs(row[:, None] - row[self._lit])
        return cost.argmin(axis=1).reshape(self.declinations, self.hours)

    def weights(self, true_rad: float, azimuth_rad: float) -> list[tuple[int, float]]:
        """Places and weights for a geometric elevation and an azimuth from north."""
        low, high = TAKES_OVER_RAD
        day = float(np.clip((true_rad - low) / (high - low), 0.0, 1.0))
        found = [] if day == 0.0 else self._by_day(true_rad, azimuth_rad)
        dusk = [] if day == 1.0 else self._by_dusk(true_rad, azimuth_rad)
        return [
            *((place, day * weight) for place, weight in found),
            *((place, (1.0 - day) * weight) for place, weight in dusk),
        ]

    def _by_day(self, true_rad: float, azimuth_rad: float) -> list[tuple[int, float]]:
        declination, hour = equatorial(true_rad, azimuth_rad, self.latitude_rad)
        step = 2.0 * MOST_DECLINATION_RAD / (self.declinations - 1)
        v = np.clip((declination + MOST_DECLINATION_RAD) / step, 0.0, self.declinations - 1)
        u = (hour % (2.0 * np.pi)) / (2.0 * np.pi) * self.hours
        row, column = min(int(v), self.declinations - 2), int(u)
        along, across = cubic(u - column), list(cubic(float(v - row)))
        # Beyond the first and the last row light goes on evenly.
        if row == 0:
            across = [0.0, across[1] + 2.0 * across[0], across[2] - across[0], across[3]]
        if row == self.declinations - 2:
            across = [across[0], across[1] - across[3], across[2] + 2.0 * across[3], 0.0]
        return [
            (
                int(self.day_nodes[row + j - 1, (column + i - 1) % self.hours]),
                across[j] * along[i],
            )
            for j in range(4)
            if across[j]
            for i in range(4)
        ]

    def _by_dusk(self, true_rad: float, azimuth_rad: float) -> list[tuple[int, float]]:
        at = float(np.interp(true_rad, DUSK_RAD, np.arange(len(DUSK_RAD))))
        row = min(int(at), len(DUSK_RAD) - 2)
        u = (azimuth_rad % (2.0 * np.pi)) / (2.0 * np.pi) * self.dusk_azimuths
        column, share = int(u), at - row
        return [
            (
                self.first_of_dusk
                + (row + j) * self.dusk_azimuths
                + (column + i - 1) % self.dusk_azimuths,
                (share if j else 1.0 - share) * weight,
            )
            for j in range(2)
            for i, weight in enumerate(cubic(u - column))
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

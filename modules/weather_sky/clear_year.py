"""The cloudless sky of a year of weather, and how cloudy its hours are.

The file's clearest hours tell how much light the air of a season lets through: in the 31 days
around a day, the tenth of the hours whose sun is brightest relative to Meinel's clear sky. The mean
ratios of their irradiances to Meinel's scale that sky. In real years the sun's are 0.75 to 1.2 by
month (Amsterdam, Chicago), within 0.15 of medians of hours that observers called cloudless.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.messages.cloudiness import CloudinessChanged
from vrut_lite.messages.weather import SetWeather
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.suns import suns_of_year
from weather_sky.perez import LOWEST_SUN_RAD, SOLAR_CONSTANT_W_M2, air_mass, distance_factor

_HALF_SEASON_DAYS, _CLEAREST = 15, 0.9
# Least elevations of the sun at which an hour's light is used to estimate the air, and clouds.
_LEAST_FOR_AIR_RAD, _LEAST_FOR_CLOUDS_RAD = np.radians(10.0), np.radians(5.0)
# Most direct light relative to the sun above the air; most light relative to a clear sky, with the
# bright sides of clouds.
_MOST_DIRECT, _MOST_SHARE = 0.95, 1.5


class Irradiances(NamedTuple):
    """Broadband (...,), W m^-2: direct on a plane that faces the sun, diffuse on level ground."""

    direct_normal_w_m2: FloatArray
    diffuse_horizontal_w_m2: FloatArray

    def on_level(self, elevation_rad: ArrayLike) -> FloatArray:
        """Irradiance of sun and sky on level ground."""
        return self.direct_normal_w_m2 * np.sin(elevation_rad) + self.diffuse_horizontal_w_m2


def meinel(elevation_rad: ArrayLike, day_of_year: ArrayLike) -> Irradiances:
    """A clear sky (Meinel 1976); no diffuse light where the sun is down.

    The sun's share of its irradiance above the air is 0.7 to the power of air mass^0.678; the sky's
    light on level ground is a tenth of it.
    """
    elevation = np.asarray(elevation_rad, dtype=float)
    above = SOLAR_CONSTANT_W_M2 * distance_factor(day_of_year)
    zenith = np.clip(0.5 * np.pi - elevation, 0.0, LOWEST_SUN_RAD)
    direct = np.asarray(above * 0.7 ** air_mass(zenith) ** 0.678)
    return Irradiances(direct, np.where(elevation > 0.0, 0.1 * direct, 0.0))


class ClearYear:
    """The clear skies of a year; `row` is an hour's number in the file."""

    def __init__(self, weather: SetWeather):
        direct = np.array(weather.direct_normal_w_m2)
        diffuse = np.array(weather.diffuse_horizontal_w_m2)
        self._measured = Irradiances(direct, diffuse)
        self._cover = weather.cloud_cover
        self._elevation_rad = suns_of_year(weather).apparent_elevation_rad
        self._day = np.arange(direct.size) // 24
        usual = meinel(self._elevation_rad, self._day + 1)
        self._ratios = np.stack([direct, diffuse]) / np.stack(
            [usual[0], np.maximum(usual[1], 1e-9)]
        )
        self._shares: dict[int, tuple[float, float]] = {}

    def irradiances(self, row: int, elevation_rad: float) -> Irradiances:
        """Irradiances of the cloudless sky, with the sun at an apparent elevation."""
        day = int(self._day[row])
        direct_share, diffuse_share = self._shares_of(day)
        usual = meinel(elevation_rad, day + 1)
        most = _MOST_DIRECT * SOLAR_CONSTANT_W_M2 * distance_factor(day + 1)
        return Irradiances(np.minimum(direct_share * usual[0], most), diffuse_share * usual[1])

    def cloudiness(self, row: int, source: str) -> CloudinessChanged:
        """Cloudiness of an hour; without a measured cover by Kasten and Czeplak's relation (1980).

        By night, without a measured cover, the sky counts as cloudless.
        """
        elevation = float(self._elevation_rad[row])
        share, direct = None, 0.0
        if elevation >= _LEAST_FOR_CLOUDS_RAD:
            measured = Irradiances(*(values[row] for values in self._measured)).on_level(elevation)
            sky = self.irradiances(row, elevation)
            clear = float(sky.on_level(elevation))
            share = float(np.clip(measured / clear, 0.0, _MOST_SHARE))
            direct = 1.0 - float(sky.diffuse_horizontal_w_m2) / clear
        if self._cover:
            cover = self._cover[row]
        else:
            cover = float(np.clip((1.0 - (1.0 if share is None else share)) / 0.75, 0.0, 1.0))
            cover = cover ** (1.0 / 3.4)
        return CloudinessChanged(
            cover=cover,
            global_share=share,
            direct_share=direct,
            sun_elevation_rad=elevation,
            source=source,
        )

    def _shares_of(self, day: int) -> tuple[float, float]:
        """Direct and diffuse light of the season's clear skies, relative to Meinel's."""
        if day not in self._shares:
            days = self._day[-1] + 1
            apart = np.abs((self._day - day + days // 2) % days - days // 2)
            near = (apart <= _HALF_SEASON_DAYS) & (self._elevation_rad >= _LEAST_FOR_AIR_RAD)
            direct, diffuse = self._ratios[:, near]
            if not direct.size or direct.max() <= 0.0:
                self._shares[day] = 1.0, 1.0
            else:
                clearest = direct >= np.quantile(direct, _CLEAREST)
                self._shares[day] = float(direct[clearest].mean()), float(diffuse[clearest].mean())
        return self._shares[day]

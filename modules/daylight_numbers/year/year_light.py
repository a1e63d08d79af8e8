"""The light of a year, hour by hour: what the holder of the sky says at the middle of each hour.

The sky may be that of a year of weather or a clear one: it comes by messages, as any hour's.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta

import numpy as np
from light_transport.public import GROUND_NODE, node_radiances
from numpy.typing import NDArray

from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.sky_cells import node_weights
from daylight_numbers.year.sun_height_skies import HeightSkies, height_skies, spread_heights
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.frames import world_from_enu
from vrut_lite.messages.place import SetPlace
from vrut_lite.numeric_types import Float32Array, FloatArray, IntArray
from vrut_lite.sky.sun_track import SunTrack
from vrut_lite.sky.suns import Suns

DAYS, HOURS = 365, 24
# A year of 365 days.
YEAR = 2025
# Hours at which a sky of heights is tried, and differences of it (rms over the sky, as a share of
# its mean) with which it is taken; fewer hours than these are made one by one.
_TRIED, _MOST_OFF, _FEW = 16, 0.1, 400
# Hours with a lower sun have no light that counts.
_LOWEST_SUN_DEG = -4.0


@dataclass(frozen=True, eq=False)
class YearLight:
    """The light of the hours (H) of a year that have some; linear sRGB, world axes.

    Attributes:
        hour: (H,) int, of the year from its first, in the place's standard time: 24 a day.
        sky: (H, GROUND_NODE + 1, 3) float32, radiance of the sky's cells and of open ground.
        sun_direction: (H, 3); sun_irradiance_rgb: (H, 3), W m^-2 on a plane that faces it.
        ground_albedo_rgb: of the ground disc.
        source: who made the sky.
    """

    hour: NDArray[np.int64]
    sky: Float32Array
    sun_direction: FloatArray
    sun_irradiance_rgb: FloatArray
    ground_albedo_rgb: FloatArray
    source: str

    def some(self, chosen: IntArray) -> "YearLight":
        """Those hours (H,) that are chosen."""
        return replace(
            self,
            hour=self.hour[chosen],
            sky=self.sky[chosen],
            sun_direction=self.sun_direction[chosen],
            sun_irradiance_rgb=self.sun_irradiance_rgb[chosen],
        )

    @property
    def diffuse_lux(self) -> FloatArray:
        """Illuminance (H,) on open level ground without the sun's own."""
        light = np.einsum("hkc,k->hc", self.sky[:, :GROUND_NODE], node_weights())
        return np.asarray(luminance(light) * LUMENS_PER_WATT)


def middle_of(hour: int, offset_h: float, year: int = YEAR) -> datetime:
    """The instant in the middle of an hour of a year of 365 days."""
    first = datetime(year, 1, 1, tzinfo=UTC) - timedelta(hours=offset_h)
    return first + timedelta(hours=hour + 0.5)


def lit_hours(place: SetPlace, offset_h: float) -> NDArray[np.int64]:
    """Hours of the year whose sun is at most a little below the horizon."""
    hour = np.arange(DAYS * HOURS)
    day, clock = hour // HOURS, hour % HOURS + 0.5
    # Spencer 1971: declination to 0.1 degrees, equation of time to half a minute.
    b = 2.0 * np.pi * day / 365.0
    tilt = 0.006918 - 0.399912 * np.cos(b) + 0.070257 * np.sin(b) - 0.006758 * np.cos(2 * b)
    tilt += 0.000907 * np.sin(2 * b)
    minutes = 229.18 * (0.000075 + 0.001868 * np.cos(b) - 0.032077 * np.sin(b))
    minutes += 229.18 * (-0.014615 * np.cos(2 * b) - 0.040849 * np.sin(2 * b))
    solar = clock + minutes / 60.0 + place.longitude_deg / 15.0 - offset_h
    turn, latitude = np.radians(15.0 * (solar - 12.0)), np.radians(place.latitude_deg)
    sine = np.sin(latitude) * np.sin(tilt) + np.cos(latitude) * np.cos(tilt) * np.cos(turn)
    return np.flatnonzero(sine > np.sin(np.radians(_LOWEST_SUN_DEG)))


def year_light(
    opened: OpenedScene,
    hours: NDArray[np.int64],
    offset_h: float,
    tracked: Callable[[Iterable[int], int], Iterable[int]],
) -> YearLight:
    """The light of some hours.

    A sky that depends on the sun's height alone is made for some heights (`sun_height_skies`);
    whether it does is tried at `_TRIED` other hours. Any other sky is made for each hour.

    Args:
        opened: the scene, whose clock is moved.
        hours: of the year.
        offset_h: standard time ahead of UTC.
        tracked: goes through so many numbers, and may show progress.

    Raises:
        UserError: the sky has no light for an hour.
    """
    opened.coarser()
    made = _MadeHours(opened, hours, offset_h)
    suns = suns_of(opened.place, hours, offset_h)
    chosen = spread_heights(suns.apparent_elevation_rad)
    others = np.setdiff1d(np.arange(len(hours)), chosen)
    tried = others[:: -(-len(others) // _TRIED)] if len(others) > _FEW else others
    for n in tracked([*chosen, *tried], len(chosen) + len(tried)):
        made.make(int(n))
    left = np.setdiff1d(others, tried)
    if len(left):
        azimuth = suns.azimuth_rad + opened.place.north_offset_rad
        skies = made.by_height(chosen, suns.apparent_elevation_rad, azimuth)
        found = {
            int(n): skies.between(float(suns.apparent_elevation_rad[n]), float(azimuth[n]))
            for n in others
        }
        if all(made.is_like(int(n), *found[int(n)]) for n in tried):
            towards = world_from_enu(suns.east_north_up, opened.place.north_offset_rad)
            for n in left:
                made.sky[n], made.sun[n] = found[int(n)]
                made.towards[n] = towards[n]
                made.albedo[n] = np.nan
        else:
            for n in tracked(left.tolist(), len(left)):
                made.make(int(n))
    albedo = np.nanmedian(made.albedo, axis=0)
    return YearLight(hours, made.sky, made.towards, made.sun, albedo, opened.source)


def suns_of(place: SetPlace, hours: NDArray[np.int64], offset_h: float) -> Suns:
    """The suns (H,) in the middle of hours."""
    seconds = middle_of(0, offset_h).timestamp() + 3600.0 * hours
    track = SunTrack(float(seconds[0]), float(seconds[-1]))
    return track.suns(seconds, place.latitude_deg, place.longitude_deg, place.altitude_m)


class _MadeHours:
    """Light of hours by the kernel, and its arrays; see `YearLight`."""

    def __init__(self, opened: OpenedScene, hours: NDArray[np.int64], offset_h: float):
        self._opened, self._hours, self._offset_h = opened, hours, offset_h
        self._cubes: dict[int, NDArray[np.floating]] = {}
        self.sky = np.zeros((len(hours), GROUND_NODE + 1, 3), np.float32)
        self.towards, self.sun = np.zeros((2, len(hours), 3))
        self.albedo = np.zeros((len(hours), 3))

    def make(self, n: int) -> None:
        """The light of an hour."""
        opened = self._opened
        opened.go_to(middle_of(int(self._hours[n]), self._offset_h))
        hour = opened.hour()
        self._cubes[n] = hour.sky
        self.sky[n] = node_radiances(hour.sky, hour.ground_radiance_rgb)[: GROUND_NODE + 1]
        self.towards[n] = hour.key_direction
        self.sun[n] = hour.key_irradiance_rgb if opened.lit_by_sun else 0.0
        self.albedo[n] = hour.ground_albedo_rgb

    def by_height(
        self, chosen: IntArray, height_rad: FloatArray, azimuth_rad: FloatArray
    ) -> HeightSkies:
        """Skies of hours that are made."""
        cubes = [self._cubes[int(n)] for n in chosen]
        ground = self.sky[chosen, GROUND_NODE].astype(float)
        return height_skies(
            height_rad[chosen], azimuth_rad[chosen], cubes, ground, self.sun[chosen]
        )

    def is_like(self, n: int, sky: FloatArray, sun: FloatArray) -> bool:
        """Whether an hour that is made has this sky and sun."""
        made = self.sky[n].astype(float)
        level = luminance(made[:GROUND_NODE]).mean() + 1e-9
        off = np.sqrt(np.mean(luminance(made - sky)[:GROUND_NODE] ** 2)) / level
        direct = luminance(self.sun[n] - sun) / (luminance(self.sun[n]) + np.pi * level)
        return bool(off < _MOST_OFF and abs(direct) < _MOST_OFF)

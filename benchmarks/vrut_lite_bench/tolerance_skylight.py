"""How far DynamicSkyLight's pictures are off, by size: against its exact twin in float64.

Random hours: turbidity from 1 to 10, albedo from 0 to 1; one in four suns between 18 degrees below
the horizon and the horizon, the others anywhere above.
"""

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from dynamic_skylight.daylight import Daylight
from dynamic_skylight.sun_step import sun_step_rad
from dynamic_skylight.tolerance import Quality
from dynamic_skylight.twilight import sky_of_hour

from vrut_lite.daylight.tolerance import Point
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.numeric_types import FloatArray

CUBE_SIZES = (32, 64, 96, 128, 192, 256, 384, 512, 768, 1024)
LIGHT_SIZES = (8, 16, 24, 32, 48, 64, 96, 128, 256)
_TRUE_LIGHT_SIZE = 512
_DIRECTIONS, _NORMALS = 4096, 256
# What is darker than this share of a picture's brightest is measured by that.
_FLOOR = 1e-3
_MOST = 0.99


class Hour(NamedTuple):
    """A random hour, and where in its step an unfollowed sun has strayed: length, direction."""

    turbidity: float
    albedo: float
    elevation_rad: float
    azimuth_rad: float
    strayed: tuple[float, float]


def random_hours(count: int, seed: int) -> list[Hour]:
    """So many, always the same for a seed."""
    rng = np.random.default_rng(seed)
    return [_hour(rng, index) for index in range(count)]


def _hour(rng: np.random.Generator, index: int) -> Hour:
    low, high = (0.0, 90.0) if index % 4 else (-18.0, 0.0)
    turbidity, albedo, elevation = rng.uniform((1.0, 0.0, low), (10.0, 1.0, high))
    azimuth, length, turn = rng.uniform((-np.pi, 0.0, -np.pi), (np.pi, 1.0, np.pi))
    return Hour(
        float(turbidity), float(albedo), float(np.radians(elevation)), float(azimuth),
        (float(length), float(turn)),
    )  # fmt: skip


def fronts(hours: list[Hour]) -> dict[str, list[Point[int | str]]]:
    """Error, texels and CPU time of each size."""
    cube_error = np.array([[cube_error_of(hour, size) for size in CUBE_SIZES] for hour in hours])
    light_error = np.array([_light_errors(hour) for hour in hours])
    return {
        "cube_size": _front(CUBE_SIZES, cube_error, cube_ms),
        "light_size": _front(LIGHT_SIZES, light_error, light_ms),
    }


def _front(
    sizes: tuple[int, ...], error: FloatArray, cost_ms: Callable[[int], float]
) -> list[Point[int | str]]:
    """Of errors (pictures, sizes)."""
    most = np.quantile(error, _MOST, axis=0)
    return [
        Point(choice=size, error=float(e), work=6.0 * size * size, cpu_ms=cost_ms(size))
        for size, e in zip(sizes, most, strict=True)
    ]


def picture_error(hour: Hour, quality: Quality) -> float:
    """Error of what is shown at this quality, of sky and of light on surfaces."""
    shown = _strayed(hour, quality.sun_change)
    sky = cube_error_of(hour, quality.cube_size, shown)
    light = _light_error(_lit(shown, quality.light_size), _lit(hour, _TRUE_LIGHT_SIZE))
    return max(sky, light)


def cube_error_of(hour: Hour, size: int, shown: Hour | None = None) -> float:
    """What 99 % of the sky's directions stay below, looked up in a cube map of the shown hour."""
    directions = _random_directions()
    sky = sky_of_hour(hour.turbidity, hour.albedo, hour.elevation_rad)
    sun = _direction(sky.sun_elevation_rad, hour.azimuth_rad)
    gamma = np.arccos(np.clip(directions @ sun, -1.0, 1.0))
    exact = sky.radiance(np.arccos(directions[:, 1]), gamma)
    values, scale = _daylight(shown or hour).encoded_background(size)
    seen = sample_sky(decode_float16(values, scale), directions)
    return _most_of(seen, exact)


def _light_errors(hour: Hour) -> list[float]:
    exact = _lit(hour, _TRUE_LIGHT_SIZE)
    return [_light_error(_lit(hour, size), exact) for size in LIGHT_SIZES]


def _light_error(light: FloatArray, exact: FloatArray) -> float:
    return float((np.abs(light - exact) / np.maximum(exact, _FLOOR * exact.max())).max())


def _lit(hour: Hour, light_size: int) -> FloatArray:
    """Irradiance (normals, 3) by sky and ground, and the ground's radiance (3,) below it."""
    daylight = _daylight(hour, light_size)
    normals = _random_directions()[:_NORMALS]
    normals[::2, 1] *= -1.0
    irradiance = evaluate_irradiance(daylight.ambient(), normals)
    return np.concatenate([irradiance, daylight.ground_rgb[None]])


def _strayed(hour: Hour, change: float) -> Hour:
    """The hour whose sky is shown while the sun moves on, unfollowed."""
    length, turn = hour.strayed
    step_rad = length * sun_step_rad(hour.elevation_rad, change)
    level = max(float(np.cos(hour.elevation_rad)), 1e-6)
    elevation_rad = hour.elevation_rad + step_rad * np.sin(turn)
    return hour._replace(
        elevation_rad=float(np.clip(elevation_rad, -np.pi / 2, np.pi / 2)),
        azimuth_rad=float(hour.azimuth_rad + step_rad * np.cos(turn) / level),
    )


def _daylight(hour: Hour, light_size: int = 64) -> Daylight:
    return Daylight(
        turbidity=hour.turbidity,
        albedo=hour.albedo,
        sun_colour="disc",
        apparent_elevation_rad=hour.elevation_rad,
        sun_azimuth_rad=hour.azimuth_rad,
        visible_disc_fraction=1.0 if hour.elevation_rad > 0.0 else 0.0,
        light_size=light_size,
    )


def cube_ms(size: int) -> float:
    """CPU time of a background, the sky's and the ground's light apart."""
    daylight = _daylight(Hour(3.0, 0.1, 0.8, 0.3, (0.0, 0.0)))
    return _least_ms(lambda: daylight.encoded_background(size))


def light_ms(size: int) -> float:
    """CPU time of the light on the scene."""
    hour = Hour(3.0, 0.1, 0.8, 0.3, (0.0, 0.0))
    return _least_ms(lambda: _daylight(hour, size).ambient())


def _least_ms(run: Callable[[], object], rounds: int = 5) -> float:
    times = []
    for _ in range(rounds + 1):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return round(1e3 * min(times), 3)


def _most_of(seen: FloatArray, exact: FloatArray) -> float:
    error = np.abs(seen - exact) / np.maximum(exact, _FLOOR * exact.max())
    return float(np.quantile(error, _MOST))


def _direction(elevation_rad: float, azimuth_rad: float) -> FloatArray:
    level = np.cos(elevation_rad)
    return np.array(
        [level * np.sin(azimuth_rad), np.sin(elevation_rad), -level * np.cos(azimuth_rad)]
    )


def _random_directions() -> FloatArray:
    """Unit vectors (n, 3), even over the upper half of the sphere."""
    rng = np.random.default_rng(0)
    height, azimuth = rng.uniform(0.0, 1.0, _DIRECTIONS), rng.uniform(-np.pi, np.pi, _DIRECTIONS)
    level = np.sqrt((1.0 - height) * (1.0 + height))
    return np.stack([level * np.sin(azimuth), height, -level * np.cos(azimuth)], axis=-1)

"""The sizes that DynamicSkyLight chooses by the tolerance, and the hours that they are measured in.

Random hours: turbidity from 1 to 10, albedo from 0 to 1; one in four suns between 18 degrees below
the horizon and the horizon, the others anywhere above. The truth is the float64 model itself.
"""

from typing import NamedTuple

import numpy as np
from dynamic_skylight.daylight import Daylight
from dynamic_skylight.sun_step import sun_step_rad
from dynamic_skylight.tolerance import FRONTS, HosekWilkieQuality, quality_for
from dynamic_skylight.twilight import sky_of_hour

from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.tolerance.knobs import FLOOR, Knob, ToleranceKnobs, Truth, picture_error

CUBE_SIZES = (32, 64, 96, 128, 192, 256, 384, 512, 768, 1024)
LIGHT_SIZES = (8, 16, 24, 32, 48, 64, 96, 128, 256)
_TRUE_LIGHT_SIZE = 512
_DIRECTIONS, _NORMALS = 4096, 256
_MEASURING_SEED, _CHECKING_SEED = 1, 2


class Hour(NamedTuple):
    """A random hour, and how far an unfollowed sun has moved within its step: length, direction."""

    turbidity: float
    albedo: float
    elevation_rad: float
    azimuth_rad: float
    strayed: tuple[float, float]


_TIMED = Hour(3.0, 0.1, 0.8, 0.3, (0.0, 0.0))


def random_hours(count: int, seed: int) -> list[Hour]:
    """So many hours, always the same for a seed."""
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


def truth(hour: Hour) -> Truth:
    """The sky's exact radiance (n, 3) in random directions, and the light on the scene."""
    directions = _random_directions()
    sky = sky_of_hour(hour.turbidity, hour.albedo, hour.elevation_rad)
    sun = _direction(sky.sun_elevation_rad, hour.azimuth_rad)
    gamma = np.arccos(np.clip(directions @ sun, -1.0, 1.0))
    return [sky.radiance(np.arccos(directions[:, 1]), gamma), _lit(hour, _TRUE_LIGHT_SIZE)]


def hour_error(hour: Hour, exact: Truth, quality: HosekWilkieQuality) -> float:
    """The larger error of sky and light on surfaces at this quality, with the sun strayed."""
    shown, (sky, light) = _strayed(hour, quality.sun_change), exact
    return max(
        picture_error(_looked_up(shown, quality.cube_size), sky),
        _light_error(_lit(shown, quality.light_size), light),
    )


def _cube_errors(hour: Hour, exact: Truth) -> FloatArray:
    return np.array([[picture_error(_looked_up(hour, size), exact[0]) for size in CUBE_SIZES]])


def _light_errors(hour: Hour, exact: Truth) -> FloatArray:
    return np.array([[_light_error(_lit(hour, size), exact[1]) for size in LIGHT_SIZES]])


def _looked_up(hour: Hour, size: int) -> FloatArray:
    """The sky (n, 3) looked up in a cube map."""
    values, scale = _daylight(hour).encoded_background(size)
    return sample_sky(decode_float16(values, scale), _random_directions())


def _light_error(light: FloatArray, exact: FloatArray) -> float:
    return float((np.abs(light - exact) / np.maximum(exact, FLOOR * exact.max())).max())


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


def _texels(size: int) -> float:
    return 6.0 * size * size


KNOBS = ToleranceKnobs(
    fronts=FRONTS,
    knobs={
        "cube_size": Knob(CUBE_SIZES, _cube_errors, _texels, _daylight(_TIMED).encoded_background),
        "light_size": Knob(
            LIGHT_SIZES, _light_errors, _texels, lambda size: _daylight(_TIMED, size).ambient()
        ),
    },
    samples=lambda pictures: (
        random_hours(pictures, _MEASURING_SEED),
        random_hours(pictures, _CHECKING_SEED),
    ),
    truth=truth,
    picture_errors=lambda hour, exact, tolerance: [hour_error(hour, exact, quality_for(tolerance))],
)

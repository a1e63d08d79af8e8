"""The whole sphere around an observer: sky above, a level ground in its light below."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.sky_view import SkyView, fill_cube, sky_view
from bruneton_sky.sun_light import sun_irradiance_rgb
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.spherical_harmonics import (
    horizontal_irradiance,
    irradiance_coefficients,
)

LIGHT_SIZE = 64


class Surroundings(NamedTuple):
    """Light of sun, sky and ground at one place; RGB is linear sRGB."""

    view: SkyView
    sun_irradiance_rgb: NDArray[np.float64]
    ground_radiance_rgb: NDArray[np.float64]


def surroundings(
    atmosphere: Atmosphere,
    altitude_m: float,
    sun_direction: ArrayLike,
    visible_disc_fraction: float = 1.0,
) -> Surroundings:
    """Sun, sky and ground for an observer; `sun_direction` (3,) is apparent, in world axes.

    The observer stands on level ground that reaches to the horizon at the observer's own
    altitude. The ground's radiance is albedo / pi times the irradiance of sky and sun on it.
    """
    direction = np.asarray(sun_direction, dtype=float)
    direction = direction / np.linalg.norm(direction)
    view = sky_view(atmosphere, altitude_m, direction)
    sun = sun_irradiance_rgb(atmosphere, altitude_m, float(direction[1]), visible_disc_fraction)
    # The sky lights the ground through its own small cube: no picture size changes the light.
    sky = horizontal_irradiance(fill_cube(view, LIGHT_SIZE, np.zeros(3)))
    irradiance = sky + sun * max(float(direction[1]), 0.0)
    return Surroundings(view, sun, albedo_rgb(atmosphere) / np.pi * irradiance)


def background_cube(around: Surroundings, size: int) -> NDArray[np.float32]:
    """Radiance (6, size, size, 3) of sky and ground without the sun's disc, W m^-2 sr^-1."""
    return fill_cube(around.view, size, around.ground_radiance_rgb)


def ambient_coefficients(around: Surroundings) -> NDArray[np.float32]:
    """Harmonics (25, 3) of the irradiance of sky and ground, without the sun, W m^-2."""
    cube = background_cube(around, LIGHT_SIZE)
    return irradiance_coefficients(cube).astype(np.float32)


def albedo_rgb(atmosphere: Atmosphere) -> NDArray[np.float64]:
    """The ground's albedo (3,) per channel: its colour in sunlight over the sunlight's."""
    sun = np.asarray(atmosphere.solar_irradiance)
    lit = rgb_from_spectrum(sun * atmosphere.ground_albedo, atmosphere.wavelength_nm, 0.0)
    return np.clip(lit / rgb_from_spectrum(sun, atmosphere.wavelength_nm, 0.0), 0.0, 1.0)

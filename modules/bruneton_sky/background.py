"""The whole sphere around an observer, and the light that falls on the scene."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.sky_view import STANDING_M, SkyView, fill_cube, sky_view
from bruneton_sky.solver import SourceField
from bruneton_sky.sun_light import sun_irradiance_rgb
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.spherical_harmonics import (
    horizontal_irradiance,
    irradiance_coefficients,
)

LIGHT_SIZE = 64


class Surroundings(NamedTuple):
    """Light of sun, sky and ground at one place; RGB is linear sRGB.

    `view`: what the observer sees. `standing`: what is seen from the ground, where the scene
    is; the same for an observer who stands there.
    """

    view: SkyView
    standing: SkyView
    sun_irradiance_rgb: NDArray[np.float64]
    ground_radiance_rgb: NDArray[np.float64]


def surroundings(
    field: SourceField,
    altitude_m: float,
    sun_direction: ArrayLike,
    visible_disc_fraction: float = 1.0,
    sunlight: Atmosphere | None = None,
) -> Surroundings:
    """Sun, sky and ground for an observer above level ground.

    Args:
        field: the solved atmosphere.
        altitude_m: of the observer, above the ground; below it counts as on it.
        sun_direction: (3,) to the apparent sun, in world axes.
        visible_disc_fraction: how much of the disc the horizon leaves.
        sunlight: the same atmosphere at more wavelengths, for the colour of a low sun; that of
            the field where there is none.
    """
    spectral = sunlight or field.atmosphere
    direction = np.asarray(sun_direction, dtype=float)
    direction = direction / np.linalg.norm(direction)
    mu_s = float(np.clip(direction[1], -1.0, 1.0))
    standing = sky_view(field, 0.0, direction)
    view = standing if altitude_m <= STANDING_M else sky_view(field, altitude_m, direction)
    sun = sun_irradiance_rgb(spectral, 0.0, mu_s, visible_disc_fraction)
    # The sky lights the ground through its own small cube: no picture size changes the light.
    sky = horizontal_irradiance(fill_cube(standing, LIGHT_SIZE, np.zeros(3)))
    reflected = albedo_rgb(spectral) / np.pi * (sky + sun * max(mu_s, 0.0))
    return Surroundings(view, standing, sun, reflected)


def background_cube(around: Surroundings, size: int) -> NDArray[np.float32]:
    """Radiance (6, size, size, 3) of sky and ground without the sun's disc, W m^-2 sr^-1."""
    return fill_cube(around.view, size, around.ground_radiance_rgb)


def ambient_coefficients(around: Surroundings) -> NDArray[np.float32]:
    """Harmonics (25, 3) of the irradiance on the scene by sky and ground, W m^-2."""
    cube = fill_cube(around.standing, LIGHT_SIZE, around.ground_radiance_rgb)
    return irradiance_coefficients(cube).astype(np.float32)


def albedo_rgb(atmosphere: Atmosphere) -> NDArray[np.float64]:
    """The ground's albedo (3,) per channel: its colour in sunlight over the sunlight's."""
    sun = np.asarray(atmosphere.solar_irradiance)
    lit = rgb_from_spectrum(sun * atmosphere.ground_albedo, atmosphere.wavelength_nm, 0.0)
    return np.clip(lit / rgb_from_spectrum(sun, atmosphere.wavelength_nm, 0.0), 0.0, 1.0)

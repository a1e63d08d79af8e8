"""Sun, sky and ground around an observer, and their light on the scene."""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.sky_view import SkyView, fill_cube, light_view, sky_view, standing_m
from bruneton_sky.solver import SourceField
from bruneton_sky.sun_light import DiscLight, disc_light, sun_irradiance_rgb
from vrut_lite.atmosphere.ground_reflectance import sunlit_albedo
from vrut_lite.geometry.cube_map import texel_directions, texel_solid_angles
from vrut_lite.geometry.spherical_harmonics import basis, irradiance_coefficients

LIGHT_SIZE = 64
# Normals of level surfaces.
_LEVELS = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Light of sun, sky and ground at one place; RGB is linear sRGB.

    Attributes:
        field: the solved atmosphere.
        altitude_m: of the observer above the ground; 0 for one who stands on it.
        sun_direction: unit vector (3,) in world axes.
        finer: factor on the sizes of the observer's table.
        standing: the sky-view table of an observer on the ground, where the scene is.
        is_whole: whether `standing` is as large as a table that is shown.
        sun_irradiance_rgb, ground_radiance_rgb: (3,).
        disc: the sun as seen from aloft, None for an observer on the ground.
    """

    field: SourceField
    altitude_m: float
    sun_direction: NDArray[np.float64]
    finer: float
    standing: SkyView
    is_whole: bool
    sun_irradiance_rgb: NDArray[np.float64]
    ground_radiance_rgb: NDArray[np.float64]
    disc: DiscLight | None

    @cached_property
    def view(self) -> SkyView:
        """The observer's sky-view table; where a graphics card makes it, nobody asks."""
        if self.is_whole and self.disc is None:
            return self.standing
        return sky_view(self.field, self.altitude_m, self.sun_direction, self.finer)


def surroundings(
    field: SourceField,
    altitude_m: float,
    sun_direction: ArrayLike,
    visible_disc_fraction: float = 1.0,
    sunlight: Atmosphere | None = None,
    known: Surroundings | None = None,
    finer: float = 1.0,
    view_on_card: bool = False,
) -> Surroundings:
    """Sun, sky and ground for an observer above level ground.

    Args:
        field: the solved atmosphere.
        altitude_m: of the observer above the ground; a negative one counts as 0.
        sun_direction: (3,) to the apparent sun, in world axes.
        visible_disc_fraction: share of the sun's disc above the horizon.
        sunlight: the same atmosphere at more wavelengths, for the colour of a low sun; the
            field's by default.
        known: the result for another altitude, or None: the light on the scene is taken from it.
        finer: factor on the sizes of the observer's table.
        view_on_card: whether a card makes the observer's table. Then, and for an observer aloft,
            the light on the scene is that of a small table.
    """
    direction = np.asarray(sun_direction, dtype=float)
    direction = direction / np.linalg.norm(direction)
    spectral = sunlight or field.atmosphere
    mu_s = float(np.clip(direction[1], -1.0, 1.0))
    stands = altitude_m <= standing_m(field.atmosphere)
    disc = None if stands else disc_light(spectral, altitude_m, mu_s)
    seen_m = 0.0 if stands else altitude_m
    if known is not None:
        return replace(known, altitude_m=seen_m, disc=disc)
    is_whole = stands and not view_on_card
    standing = sky_view(field, 0.0, direction, finer) if is_whole else light_view(field, direction)
    sun = sun_irradiance_rgb(spectral, 0.0, mu_s, visible_disc_fraction)
    # A separate small cube: the light on the ground does not depend on the picture's size.
    cube = fill_cube(standing, LIGHT_SIZE, np.zeros(3))
    sky = _level_weights() @ cube.reshape(-1, 3)
    reflected = albedo_rgb(spectral) / np.pi * (sky + sun * max(mu_s, 0.0))
    return Surroundings(field, seen_m, direction, finer, standing, is_whole, sun, reflected, disc)


@lru_cache(maxsize=2)
def _level_weights(up: float = 1.0) -> NDArray[np.float32]:
    """Solid angle times cosine (6 * n * n,) of a light cube's texels on a level surface, in sr.

    The surface looks up, or down if `up` is -1.
    """
    cosine = np.maximum(up * texel_directions(LIGHT_SIZE)[..., 1], 0.0)
    return (cosine * texel_solid_angles(LIGHT_SIZE)).astype(np.float32).ravel()


def background_cube(around: Surroundings, size: int) -> NDArray[np.float32]:
    """Radiance (6, size, size, 3) of sky and ground without the sun's disc, W m^-2 sr^-1."""
    return fill_cube(around.view, size, around.ground_radiance_rgb)


def ground_cube(around: Surroundings, size: int) -> NDArray[np.float32]:
    """The same, seen from the ground, where the scene is."""
    return fill_cube(around.standing, size, around.ground_radiance_rgb)


def ambient_coefficients(around: Surroundings) -> NDArray[np.float32]:
    """Harmonics (25, 3) of the irradiance on the scene by sky and ground, W m^-2.

    Level surfaces have their exact irradiance: 25 harmonics of a glow along the horizon would give
    them up to 6 % more. The least change of all coefficients does it.
    """
    cube = ground_cube(around, LIGHT_SIZE)
    coefficients = irradiance_coefficients(cube)
    levels = basis(_LEVELS)
    exact = np.stack([_level_weights(sign) @ cube.reshape(-1, 3) for sign in _LEVELS[:, 1]])
    lacking = np.linalg.solve(levels @ levels.T, exact - levels @ coefficients)
    return (coefficients + levels.T @ lacking).astype(np.float32)


def albedo_rgb(atmosphere: Atmosphere) -> NDArray[np.float64]:
    """The ground's albedo (3,) per channel: its colour in sunlight over the sunlight's."""
    return sunlit_albedo(
        atmosphere.ground_albedo, atmosphere.solar_irradiance, atmosphere.wavelength_nm
    )

"""All the light of one hour, each part computed on first use."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dynamic_skylight.background import fill_ground, ground_radiance, sphere
from dynamic_skylight.cached_cubes import kept_cube
from dynamic_skylight.hosek_wilkie.levelled_sky import LevelledSky
from dynamic_skylight.hosek_wilkie.sky import HosekWilkieSky, half_scale
from dynamic_skylight.sun_light import SunColour, SunLight, sun_behind_air, sun_light
from dynamic_skylight.twilight import BLEND_APPARENT_RAD, HourSky, sky_of_hour
from vrut_lite.atmosphere.aerosol import optical_depth_of_turbidity
from vrut_lite.geometry.encoding import encode_float16
from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.messages.haze import SetHaze
from vrut_lite.numeric_types import FloatArray, Vector

# Edge (texels) of the cube for light from the sky, whatever the picture's size.
LIGHT_SIZE = 64


@dataclass(frozen=True)
class Daylight:
    """Sky, ground and sun for one place of the sun; equal inputs make equal light.

    `sun_azimuth_rad` counts in world axes, from -Z, clockwise seen from above; `albedo` is one
    number or one per channel, `light_size` the edge of the cube that light on ground and scene is
    made from. `turbidity` and `level` are the model's, `haze` is that of the air before the scene
    and of a sun behind it; without one it has the model's turbidity. Without `starlight` the night
    is dark.
    """

    turbidity: float
    albedo: float | Vector
    sun_colour: SunColour
    apparent_elevation_rad: float
    sun_azimuth_rad: float
    visible_disc_fraction: float
    light_size: int = LIGHT_SIZE
    level: float = 1.0
    haze: SetHaze | None = None
    starlight: bool = True

    @cached_property
    def air_haze(self) -> SetHaze:
        """The haze of the air."""
        if self.haze is not None:
            return self.haze
        return SetHaze(optical_depth_550=float(optical_depth_of_turbidity(self.turbidity)))

    @cached_property
    def sky(self) -> HourSky:
        """The sky above the horizon."""
        hour = self.turbidity, self.albedo, self.apparent_elevation_rad, self.level
        return sky_of_hour(*hour, self.air_haze.turbidity, self.starlight)

    @cached_property
    def model(self) -> HosekWilkieSky | None:
        """The exact model, while the sun is so high that no twilight is blended in."""
        if self.apparent_elevation_rad < BLEND_APPARENT_RAD:
            return None
        return LevelledSky(self.turbidity, self.albedo, self.apparent_elevation_rad, self.level)

    @cached_property
    def sun(self) -> SunLight:
        """The direct light of the sun."""
        if self.sun_colour == "air":
            return sun_behind_air(
                self.air_haze, self.apparent_elevation_rad, self.visible_disc_fraction
            )
        return sun_light(
            self.turbidity,
            self.albedo,
            self.apparent_elevation_rad,
            self.visible_disc_fraction,
            self.sun_colour,
        )

    @cached_property
    def ground_rgb(self) -> FloatArray:
        """Radiance (3,) of the ground, W m^-2 sr^-1."""
        return ground_radiance(
            self._sky_cube, self.sun.irradiance_rgb, self.apparent_elevation_rad, self.albedo
        )

    def background(self, size: int) -> NDArray[np.float32]:
        """Cube map (6, size, size, 3) of radiance in world axes, without the disc."""
        return sphere(self.sky, self.ground_rgb, size, self.sun_azimuth_rad)

    def encoded_background(self, size: int) -> tuple[NDArray[np.float16], float]:
        """The background in half precision, and the power of two that brings it back."""
        if self.model is None:
            return encode_float16(self.background(size))
        cube = self._kept("half", self.model.cube_map_float16, size, self.half_scale)
        fill_ground(cube, self.ground_rgb / self.half_scale)
        return cube, self.half_scale

    @cached_property
    def half_scale(self) -> float:
        """The scale of the exact model's sky and its ground in half precision."""
        assert self.model is not None
        return half_scale(max(self.model.brightest, float(self.ground_rgb.max())))

    def ambient(self) -> FloatArray:
        """Harmonics (25, 3) of the irradiance from sky and ground, W m^-2, world axes."""
        cube = self._sky_cube.copy()
        fill_ground(cube, self.ground_rgb)
        return irradiance_coefficients(cube)

    @cached_property
    def _sky_cube(self) -> NDArray[np.float32]:
        if self.model is None:
            return self.sky.cube_map(self.light_size, self.sun_azimuth_rad)
        return self._kept("single", self.model.cube_map, self.light_size)

    def _kept(
        self, kind: str, make: Callable[..., NDArray[Any]], size: int, *more: float
    ) -> NDArray[Any]:
        """A cube map of the exact model."""
        assert self.model is not None
        azimuth_rad, elevation_rad = self.sun_azimuth_rad, self.apparent_elevation_rad
        numbers = self.model.rgb_distribution, self.model.rgb_mean_radiance
        cube = partial(make, size, azimuth_rad, *more)
        return kept_cube(cube, kind, size, azimuth_rad, elevation_rad, *more, *numbers)

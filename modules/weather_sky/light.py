"""The sky of an hour of weather, as `SkyModule` asks for it."""

from dataclasses import dataclass
from functools import cached_property

import msgspec
import numpy as np

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance, irradiance_coefficients
from vrut_lite.messages.haze import MOST_OPTICAL_DEPTH, SetHaze
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector
from vrut_lite.sky.clear_sun import sun_irradiance_rgb
from vrut_lite.sky.sky_of_hour import Background, MotionThreshold, Sky, SkyInputs, SunDisc
from vrut_lite.sky.visible_disc import MEAN_ANGULAR_RADIUS_RAD
from weather_sky.colour import TWILIGHT_K, clear_share, rgb_of_daylight, sky_rgb
from weather_sky.conditions import Conditions
from weather_sky.hemisphere import horizontal
from weather_sky.tolerance import WeatherQuality

# Edge of the cube that lights ground and scene.
_LIGHT_SIZE = 64
# Least angle (rad) over which light beside the sun falls to a third.
_STEEPEST_RAD = 0.12
# Halvings of the search for an optical depth, to 0.001.
_HALVINGS = 12


def haze_before(haze: SetHaze, conditions: Conditions) -> SetHaze:
    """As much of this haze as leaves a cloudless sun its illuminance; as it is without a sun."""
    if conditions.direct_lux <= 0.0:
        return haze
    elevation = conditions.apparent_elevation_rad
    least, most = 0.0, MOST_OPTICAL_DEPTH
    for _ in range(_HALVINGS):
        middle = 0.5 * (least + most)
        haze = msgspec.structs.replace(haze, optical_depth_550=middle)
        lux = LUMENS_PER_WATT * float(luminance(sun_irradiance_rgb(haze, elevation)))
        least, most = (middle, most) if lux > conditions.direct_lux else (least, middle)
    return haze


@dataclass(frozen=True)
class WeatherLight(Sky):
    """Sky, sun and ground; `sun_direction` is the apparent one, in world axes.

    `haze` colours the sun, and dims it for clouds.
    """

    conditions: Conditions
    sun_direction: Vector
    albedo_rgb: Vector
    haze: SetHaze

    @cached_property
    def _zenith_sun(self) -> FloatArray:
        """The sun that the distribution is turned to: at least 1 degree up."""
        x, _, z = self.sun_direction
        across, zenith = np.hypot(x, z), self.conditions.sun_zenith_rad
        level = np.array([x, z]) / across if across > 0.0 else np.array([0.0, -1.0])
        sine = np.sin(zenith)
        return np.array([level[0] * sine, np.cos(zenith), level[1] * sine])

    @cached_property
    def _scale_cd_m2(self) -> float:
        """Luminance of the unit of the distribution."""
        light = self.conditions
        return light.diffuse_lux / float(horizontal(light.distribution, light.sun_zenith_rad))

    def radiance(self, direction: FloatArray) -> FloatArray:
        """Linear sRGB (..., 3) in W m^-2 sr^-1 of the sky; below the horizon as on it."""
        light = self.conditions
        cos_gamma = direction @ self._zenith_sun
        spread = light.distribution.relative_luminance(direction[..., 1], cos_gamma)
        shown = self._scale_cd_m2 * spread
        if light.at_night:
            return (shown / LUMENS_PER_WATT)[..., None] * rgb_of_daylight(TWILIGHT_K)
        clear = 0.0 if light.hides_sun else float(clear_share(light.state.clearness))
        return sky_rgb(shown, clear)

    def background(self, size: int) -> Background:
        """The closed form at every texel's centre."""
        directions = texel_directions(size)
        cube = np.empty(directions.shape, dtype=np.float32)
        cube[:] = self._ground_rgb
        above = directions[..., 1] > 0.0
        cube[above] = self.radiance(directions[above])
        return Background(cube, self._ground_rgb)

    @cached_property
    def _sky_cube(self) -> Float32Array:
        directions = texel_directions(_LIGHT_SIZE)
        above = directions[..., 1] > 0.0
        cube = np.zeros(directions.shape, dtype=np.float32)
        cube[above] = self.radiance(directions[above])
        return cube

    @cached_property
    def _ground_rgb(self) -> FloatArray:
        falls = horizontal_irradiance(self._sky_cube)
        falls = falls + self.sun().irradiance_rgb * max(self.sun_direction[1], 0.0)
        return np.asarray(self.albedo_rgb) / np.pi * falls

    def ground_albedo_rgb(self) -> FloatArray:
        """That of the ground in sunlight."""
        return np.asarray(self.albedo_rgb)

    def sun(self) -> SunDisc:
        """The sun's light: colour by clear air, illuminance by the weather."""
        lux = self.conditions.direct_lux
        if lux <= 0.0:
            return SunDisc(np.zeros(3), MEAN_ANGULAR_RADIUS_RAD)
        tint = np.maximum(sun_irradiance_rgb(self.haze, self.conditions.apparent_elevation_rad), 0)
        shines = tint * (lux / LUMENS_PER_WATT / float(luminance(tint)))
        return SunDisc(shines, MEAN_ANGULAR_RADIUS_RAD, haze=self.haze.layers)

    def ambient(self) -> FloatArray:
        """Harmonics of a small cube of sky and ground."""
        cube = self._sky_cube.copy()
        cube[texel_directions(_LIGHT_SIZE)[..., 1] <= 0.0] = self._ground_rgb
        return irradiance_coefficients(cube)

    def unseen(self, hour: SkyInputs, quality: WeatherQuality) -> MotionThreshold:
        """The sun's by the steepest fall of light beside it; the eye's height changes nothing."""
        return MotionThreshold(_STEEPEST_RAD * quality.sun_change, np.inf)

"""The Hosek-Wilkie sky of an hour, as `SkyModule` asks for it."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from dynamic_skylight.air import TOP_ALTITUDE_M, air_is_seen, air_volume
from dynamic_skylight.daylight import Daylight
from dynamic_skylight.hosek_wilkie.coefficients import WAVELENGTHS_NM
from dynamic_skylight.hosek_wilkie.gpu_cube import gpu_cube_job
from dynamic_skylight.hosek_wilkie.levelled_sky import LevelledSky
from dynamic_skylight.sun_step import sun_step_rad
from dynamic_skylight.tolerance import HosekWilkieQuality
from vrut_lite.atmosphere.ground_reflectance import GroundReflectance
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.gpu_job import GpuJob, TexelFormat
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.sky.sky_of_hour import (
    CUBE_JOB,
    Background,
    MotionThreshold,
    Sky,
    SkyInputs,
    Spectrum,
    SunDisc,
)
from vrut_lite.sky.visible_disc import MEAN_ANGULAR_RADIUS_RAD

NAME = "dynamic_skylight"
# Over how many metres, and the eye's own height, air thins: an eye that moves by a share of it
# sees air that is as much thinner or denser.
_THINNING_M = 500.0


@dataclass(frozen=True)
class HosekWilkieLight(Sky):
    """Sky, sun, ground and air; `sun_direction` is the apparent one."""

    # Timed on llvmpipe: 0.15 to 0.25 trial pixels.
    cube_trials: ClassVar[float] = 0.25

    daylight: Daylight
    sun_direction: Vector
    ground: GroundReflectance

    def background(self, size: int) -> Background:
        """The exact model's cube by its fast fill; at twilight the blend with the table's."""
        cube, scale = self.daylight.encoded_background(size)
        return Background(cube, self.daylight.ground_rgb, scale)

    def gpu_background(self, size: int, format: TexelFormat) -> tuple[GpuJob, Background] | None:
        """By day the formula is the GPU's too; twilight is not the formula's alone."""
        light = self.daylight
        if light.model is None:
            return None
        asked = light.sun_azimuth_rad, light.ground_rgb, size, light.half_scale
        job = gpu_cube_job(NAME, CUBE_JOB, light.model, *asked, format=format)
        texture = GpuTexture(size=size, format=job.format, recipe=job.recipe)
        return job, Background(texture, light.ground_rgb, light.half_scale)

    def sun(self) -> SunDisc:
        """The sun's light, with the mean radius of the year."""
        sun = self.daylight.sun
        haze = self.daylight.air_haze.layers
        radius_rad = MEAN_ANGULAR_RADIUS_RAD
        return SunDisc(sun.irradiance_rgb, radius_rad, sun.limb_darkening_rgb, haze=haze)

    def ambient(self) -> FloatArray:
        """Harmonics of a small cube of sky and ground."""
        return self.daylight.ambient()

    def ground_albedo_rgb(self) -> FloatArray:
        """That of the ground in sunlight."""
        return np.asarray(self.ground.rgb)

    def unseen(self, hour: SkyInputs, quality: HosekWilkieQuality) -> MotionThreshold:
        """The sun's by the model's largest change; the eye's by the air's thinning."""
        return MotionThreshold(
            sun_step_rad(hour.sun.apparent_elevation_rad, quality.sun_change),
            quality.altitude_change * (_THINNING_M + hour.eye_height_m),
        )

    def air(self, eye_height_m: float, reach_m: float) -> AirVolume | None:
        """Two exponential layers that fade into this sky."""
        # From above the air, the way to it is empty.
        in_air_m = reach_m - max(eye_height_m - TOP_ALTITUDE_M, 0.0)
        if not air_is_seen(self.daylight.air_haze, eye_height_m, in_air_m):
            return None
        return air_volume(self.daylight, self.sun_direction, eye_height_m, in_air_m)

    def spectrum(self, direction: Vector) -> Spectrum:
        """The exact model's at its own bands; none at twilight, nor of the ground."""
        light = self.daylight
        if light.model is None or direction[1] <= 0.0:
            return Spectrum()
        sun = world_from_enu(
            direction_from_angles(light.sun_azimuth_rad, light.apparent_elevation_rad)
        )
        theta, gamma = (
            float(np.arccos(np.clip(cosine, -1.0, 1.0)))
            for cosine in (direction[1], np.dot(direction, sun))
        )
        hour = light.turbidity, self.ground.at(WAVELENGTHS_NM), light.apparent_elevation_rad
        radiance = LevelledSky(*hour, light.level).spectral_radiance(theta, gamma, WAVELENGTHS_NM)
        return Spectrum(tuple(WAVELENGTHS_NM.tolist()), tuple(radiance.tolist()))

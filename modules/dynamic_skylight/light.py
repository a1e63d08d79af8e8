"""The Hosek-Wilkie sky of an hour, as `SkyModule` asks for it."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from dynamic_skylight.air import TOP_ALTITUDE_M, air_is_seen, air_volume
from dynamic_skylight.daylight import Daylight
from dynamic_skylight.gpu_twilight import gpu_twilight_job
from dynamic_skylight.hosek_wilkie.coefficients import WAVELENGTHS_NM
from dynamic_skylight.hosek_wilkie.gpu_cube import gpu_cube_job
from dynamic_skylight.hosek_wilkie.levelled_sky import LevelledSky
from dynamic_skylight.hosek_wilkie.sky import SKY_NM
from dynamic_skylight.sun_step import sun_step_rad
from dynamic_skylight.tolerance import HosekWilkieQuality
from vrut_lite.atmosphere.ground_reflectance import GroundReflectance
from vrut_lite.atmosphere.sunlight import slant_depth
from vrut_lite.geometry.colour import luminance, solar_irradiance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.gpu_job import GpuJob, TexelFormat
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.sky.clear_sun import sun_irradiance_rgb
from vrut_lite.sky.sky_of_hour import (
    CUBE_JOB,
    Background,
    MotionThreshold,
    Sky,
    SkyInputs,
    SkySpectra,
    Spectrum,
    SunDisc,
)
from vrut_lite.sky.visible_disc import MEAN_ANGULAR_RADIUS_RAD

NAME = "dynamic_skylight"
# Over how many metres, and the eye's own height, air thins: an eye that moves by a share of it
# sees air that is as much thinner or denser.
_THINNING_M = 500.0
# Work of a texel of twilight on a card, in trial pixels: timed on llvmpipe.
_TWILIGHT_TRIALS = 0.35


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

    def gpu_background(self, size: int, format: TexelFormat) -> tuple[GpuJob, Background]:
        """The same by one program: by day the formula alone."""
        light = self.daylight
        if light.model is None:
            asked = light.sky, light.sun_azimuth_rad, light.ground_rgb, size
            job, scale = gpu_twilight_job(NAME, CUBE_JOB, *asked, format=format)
        else:
            scale = light.half_scale
            by_day = light.sun_azimuth_rad, light.ground_rgb, size, scale
            job = gpu_cube_job(NAME, CUBE_JOB, light.model, *by_day, format=format)
        texture = GpuTexture(size=size, format=job.format, recipe=job.recipe)
        return job, Background(texture, light.ground_rgb, scale)

    def card_cube_trials(self) -> float:
        """Twilight's map takes a little more than the formula alone."""
        return self.cube_trials if self.daylight.model is not None else _TWILIGHT_TRIALS

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

    def spectra(self, size: int, wavelength_nm: tuple[float, ...]) -> SkySpectra | None:
        """The model's sky, 0 above 760 nm, by day; the sun as the air colours it, at its own
        luminance."""
        light, nm = self.daylight, np.asarray(wavelength_nm)
        if light.model is None:
            return None
        hour = light.turbidity, self.ground.at(WAVELENGTHS_NM), light.apparent_elevation_rad
        directions = texel_directions(size)
        above = directions[..., 1] > 0.0
        cosines = np.stack([directions[above][:, 1], directions[above] @ self.sun_direction])
        theta, gamma = np.arccos(np.clip(cosines, -1.0, 1.0))
        in_range = nm <= SKY_NM[1]
        sky = LevelledSky(*hour, light.level).spectral_radiance(theta, gamma, nm[in_range])
        cube = np.zeros((*above.shape, len(nm)), np.float32)
        seen = np.zeros((len(sky), len(nm)))
        seen[:, in_range] = sky
        cube[above] = seen
        sun = self._sun_spectrum(nm)
        falls = horizontal_irradiance(cube) + sun * max(self.sun_direction[1], 0.0)
        albedo = self.ground.at(nm)
        return SkySpectra(cube, sun, albedo / np.pi * falls, albedo)

    def _sun_spectrum(self, nm: FloatArray) -> FloatArray:
        """Irradiance (W,) of the sun behind the air, with the luminance of its light in colour."""
        haze, sine = self.daylight.air_haze, max(self.sun_direction[1], 0.0)
        layers = haze.aerosol_layers, haze.nitrogen_dioxide
        shape = solar_irradiance(nm) * np.exp(-slant_depth(0.0, sine, nm, *layers))
        of_air = luminance(sun_irradiance_rgb(haze, self.daylight.apparent_elevation_rad))
        return np.asarray(shape * (luminance(self.daylight.sun.irradiance_rgb) / of_air))

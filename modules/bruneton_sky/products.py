"""What BrunetonSky says, made from an observer's surroundings."""

from bruneton_sky.air_volume import air_is_seen, air_volume
from bruneton_sky.air_volume.gpu import air_volume_job
from bruneton_sky.background import Surroundings, ambient_coefficients, background_cube
from bruneton_sky.sky_view.gpu import sky_view_job, view_shader
from bruneton_sky.solver import SourceField
from bruneton_sky.spectrum import SPECTRUM_NM, SkySpectrum
from bruneton_sky.sun_light import limb_darkening_rgb
from vrut_lite.array import Array
from vrut_lite.daylight.air import AirChanged
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged, SpectrumSeen
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.geometry.encoding import encode_float16
from vrut_lite.gpu_job import GpuJob, GpuTexture
from vrut_lite.numeric_types import Vector

NAME = "bruneton_sky"
CUBE_JOB, AIR_JOB = "cube", "air"


def background(around: Surroundings, size: int) -> BackgroundChanged:
    """The sky as an array, computed here and now."""
    values, scale = encode_float16(background_cube(around, size))
    return _background(around, Array(values), scale)


def gpu_background(around: Surroundings, size: int) -> tuple[GpuJob, BackgroundChanged]:
    """The job that computes the sky, and what to say when it is done, but for the texture."""
    job, scale = sky_view_job(around.view, size, around.ground_radiance_rgb, NAME, CUBE_JOB)
    awaited = GpuTexture(size=size, format=job.format, recipe=job.recipe)
    return job, _background(around, awaited, scale)


def sun_light(
    around: Surroundings, direction: Vector, angular_radius_rad: float
) -> KeyLightChanged:
    """The sun as the scene's light."""
    red, green, blue = around.sun_irradiance_rgb.tolist()
    return KeyLightChanged(
        direction=direction,
        irradiance_rgb=(red, green, blue),
        angular_radius_rad=angular_radius_rad,
        limb_darkening_rgb=limb_darkening_rgb(),
        source=NAME,
    )


def ambient(around: Surroundings) -> AmbientChanged:
    """The light of sky and ground on the scene."""
    return AmbientChanged(irradiance_sh_rgb=Array(ambient_coefficients(around)), source=NAME)


def air(
    field: SourceField, altitude_m: float, sun_direction: Vector, reach_m: float, on_gpu: bool
) -> tuple[GpuJob | None, AirChanged]:
    """The air before things that stand up to `reach_m` from the eye.

    On the GPU, the job that computes its light comes first, and the texture into the volume;
    but where no air is to be seen, there is nothing to compute.
    """
    # From above the air, the way to it is empty.
    above_m = max(altitude_m - field.atmosphere.top_altitude_m, 0.0)
    in_air_m = reach_m - above_m
    if not air_is_seen(field.atmosphere, altitude_m, in_air_m):
        return None, AirChanged(volume=None, source=NAME)
    where = (field, altitude_m, sun_direction, in_air_m)
    job, volume = air_volume_job(*where, NAME, AIR_JOB) if on_gpu else (None, air_volume(*where))
    return job, AirChanged(volume=volume, source=NAME)


def spectrum(seen: SkySpectrum) -> SpectrumSeen:
    """The sky's spectrum in a direction; nothing below the level, where the ground is."""
    above = seen.direction[1] > 0.0
    return SpectrumSeen(
        direction=seen.direction,
        wavelength_nm=SPECTRUM_NM if above else (),
        radiance=tuple(seen.radiance.tolist()) if above else (),
        source=NAME,
    )


def _background(around: Surroundings, cube: Array | GpuTexture, scale: float) -> BackgroundChanged:
    red, green, blue = around.ground_radiance_rgb.tolist()
    return BackgroundChanged(
        cube=cube,
        radiance_scale=scale,
        ground_radiance_rgb=(red, green, blue),
        source=NAME,
        ground_through_air=around.view.shape[1] > 0,
        view=view_shader(around.view, around.disc) if around.disc is not None else None,
        seen_sun_irradiance_rgb=_seen_sun(around),
    )


def _seen_sun(around: Surroundings) -> Vector | None:
    if around.disc is None:
        return None
    red, green, blue = around.disc.seen_rgb.tolist()
    return (red, green, blue)

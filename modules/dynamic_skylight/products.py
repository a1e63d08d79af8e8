"""What DynamicSkyLight says, made from one hour's light."""

import numpy as np
from numpy.typing import NDArray

from dynamic_skylight.air import TOP_ALTITUDE_M, air_is_seen, air_volume
from dynamic_skylight.daylight import Daylight
from dynamic_skylight.hosek_wilkie.coefficients import WAVELENGTHS_NM
from dynamic_skylight.hosek_wilkie.gpu_cube import gpu_cube_job
from dynamic_skylight.sun.disc import MEAN_ANGULAR_RADIUS_RAD
from dynamic_skylight.sun.position import Method, position_at
from vrut_lite.array import Array
from vrut_lite.daylight.air import AirChanged
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged, SpectrumSeen
from vrut_lite.daylight.sun import KeyLightChanged, SunMoved
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.gpu_job import GpuJob, GpuTexture
from vrut_lite.kernel.messages import ClockMoved
from vrut_lite.numeric_types import Vector

NAME = "dynamic_skylight"
CUBE_JOB = "cube"


def sun_moved(clock: ClockMoved, place: SetPlace, method: Method) -> SunMoved:
    """Where the sun stands, in world axes."""
    # The kernel has checked the place, and knows more years than the ephemeris is good for.
    sun = position_at(
        clock.instant, place.latitude_deg, place.longitude_deg, method, place.altitude_m
    )
    return SunMoved(
        direction=_vector(world_from_enu(sun.direction, place.north_offset_rad)),
        azimuth_rad=sun.azimuth_rad,
        elevation_rad=sun.elevation_rad,
        apparent_elevation_rad=sun.apparent_elevation_rad,
        visible_disc_fraction=sun.visible_disc_fraction,
    )


def background(daylight: Daylight, size: int) -> BackgroundChanged:
    """The sky as an array, computed here and now."""
    values, scale = daylight.encoded_background(size)
    return BackgroundChanged(
        cube=Array(values),
        radiance_scale=scale,
        ground_radiance_rgb=_vector(daylight.ground_rgb),
        source=NAME,
    )


def gpu_background(daylight: Daylight, size: int) -> tuple[GpuJob, BackgroundChanged]:
    """The job that computes the sky, and what to say when it is done, but for the texture.

    Only for an hour of the exact model.
    """
    assert daylight.model is not None
    job = gpu_cube_job(
        NAME,
        CUBE_JOB,
        daylight.model,
        daylight.sun_azimuth_rad,
        daylight.ground_rgb,
        size,
        daylight.half_scale,
    )
    awaited = BackgroundChanged(
        cube=GpuTexture(size=size, format=job.format, recipe=job.recipe),
        radiance_scale=daylight.half_scale,
        ground_radiance_rgb=_vector(daylight.ground_rgb),
        source=NAME,
    )
    return job, awaited


def sun_light(daylight: Daylight, direction: Vector) -> KeyLightChanged:
    """The sun's direct light."""
    return KeyLightChanged(
        direction=direction,
        irradiance_rgb=_vector(daylight.sun.irradiance_rgb),
        angular_radius_rad=MEAN_ANGULAR_RADIUS_RAD,
        limb_darkening_rgb=daylight.sun.limb_darkening_rgb,
        source=NAME,
    )


def ambient(daylight: Daylight) -> AmbientChanged:
    """The light of sky and ground on surfaces."""
    coefficients = daylight.ambient().astype(np.float32)
    return AmbientChanged(irradiance_sh_rgb=Array(coefficients), source=NAME)


def air(daylight: Daylight, direction: Vector, altitude_m: float, reach_m: float) -> AirChanged:
    """The air before things that stand up to `reach_m` from the eye."""
    # From above the air, the way to it is empty.
    in_air_m = reach_m - max(altitude_m - TOP_ALTITUDE_M, 0.0)
    if not air_is_seen(daylight.turbidity, altitude_m, in_air_m):
        return AirChanged(volume=None, source=NAME)
    volume = air_volume(daylight, direction, altitude_m, in_air_m)
    return AirChanged(volume=volume, source=NAME)


def spectrum(daylight: Daylight, direction: Vector) -> SpectrumSeen:
    """The exact model's spectrum at its own bands; none at twilight, nor of the ground."""
    wavelength_nm: tuple[float, ...] = ()
    radiance: tuple[float, ...] = ()
    if daylight.model is not None and direction[1] > 0.0:
        sun = world_from_enu(
            direction_from_angles(daylight.sun_azimuth_rad, daylight.apparent_elevation_rad)
        )
        theta, gamma = (
            float(np.arccos(np.clip(cosine, -1.0, 1.0)))
            for cosine in (direction[1], np.dot(direction, sun))
        )
        wavelength_nm = tuple(WAVELENGTHS_NM.tolist())
        radiance = tuple(daylight.model.spectral_radiance(theta, gamma, WAVELENGTHS_NM).tolist())
    return SpectrumSeen(
        direction=direction, wavelength_nm=wavelength_nm, radiance=radiance, source=NAME
    )


def _vector(values: NDArray[np.float64]) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z

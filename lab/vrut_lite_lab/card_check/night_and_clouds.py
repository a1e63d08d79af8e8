"""A card's cubes of twilight, of a moonlit night and of clouds."""

from dataclasses import replace
from functools import lru_cache, partial

import numpy as np
from clouds.card_cube import cloud_passes
from clouds.genera import GENERA as TYPICAL
from clouds.genera import Genus
from clouds.layer import cloud_layer
from clouds.model.cloud_light import ClearLight
from clouds.settings import Layer
from clouds.sky_under_clouds import sky_behind_clouds
from dynamic_skylight.daylight import Daylight
from dynamic_skylight.gpu_twilight import gpu_twilight_job
from dynamic_skylight.light import HosekWilkieLight
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.atmosphere.ground_reflectance import GroundReflectance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.night import MoonLight
from vrut_lite.messages.sun import sun_moved
from vrut_lite.numeric_types import Vector
from vrut_lite.sky.sky_at_night import SkyAtNight
from vrut_lite_lab.bench.bench_path import PICTURE_NORM, BenchPath, Group, Work
from vrut_lite_lab.bench.gl import GlTexture, gl_clock, has_timer, missing_gl, renderer

# Heaps, a sheet, and ice.
GENERA: tuple[Genus, ...] = ("Cu", "St", "Ci")
SIZES, CARD_SIZES = (64, 256), (64, 128, 256, 512, 1024)
CLOUD_SIZES, CLOUD_CARD_SIZES = (64,), (64, 128, 256, 512)
_AZIMUTH_RAD = 0.7
_SUN: Vector = (0.6, 0.8, 0.0)
_IRRADIANCE: Vector = (90.0, 80.0, 70.0)
_SKY_RGB = np.array([2.0, 3.0, 5.0])
_EYE_M: Vector = (0.0, 0.0, 0.0)
_ALBEDO: Vector = (0.1, 0.1, 0.1)
_FULL_MOON = 2.5e-6
# Starts the cube with an even sky.
_EVEN = """#version 430
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) writeonly uniform imageCube sky;
uniform vec3 radiance;
void main() {
    imageStore(sky, ivec3(gl_GlobalInvocationID), vec4(radiance, 1.0));
}
"""


def groups(quick: bool) -> list[Group]:
    """Cubes by kind and size."""
    has_card = not missing_gl() and has_timer(renderer())
    sizes, cloud_sizes = (CARD_SIZES, CLOUD_CARD_SIZES) if has_card else (SIZES, CLOUD_SIZES)
    kinds = [(f"twilight, {size}²", size, partial(_twilight, size)) for size in sizes]
    kinds += [(f"moonlit night, {size}²", size, partial(_moonlit, size)) for size in sizes]
    kinds += [
        (f"clouds, {genus}, {size}²", size, partial(cloud_job, genus, size))
        for genus in GENERA
        for size in cloud_sizes
    ]
    paths = [
        BenchPath(
            name=f"GPU, {name}",
            family=f"GPU, {name.rpartition(',')[0]}",
            parameters={"size": size},
            prepare=partial(_prepared, make),
            error=None,
            batch=f"GPU {size}",
            clock=gl_clock(),
            device="GPU",
        )
        for name, size, make in kinds
    ]
    return [
        Group(
            name="night-and-clouds",
            title="Cube maps of twilight, night and clouds",
            unit="a map",
            norm=f"{PICTURE_NORM} (of texels)",
            truth="the processor's, by the check of a card",
            paths=tuple(paths) if not missing_gl() else (),
            left_out={"night and clouds on the GPU": missing_gl()} if missing_gl() else {},
        )
    ]


def _prepared(make: "partial[GpuJob]") -> Work:
    return GlTexture(make())


def evening(sun_deg: float) -> Daylight:
    """The light of a low or set sun."""
    return Daylight(3.0, _ALBEDO, "air", np.radians(sun_deg), _AZIMUTH_RAD, 0.0)


def twilight_job(light: Daylight, size: int) -> tuple[GpuJob, float]:
    """The cube of an evening, and its scale."""
    where = light.sky, light.sun_azimuth_rad, light.ground_rgb, size
    return gpu_twilight_job("bench", "cube", *where, format="rgba32f")


def _twilight(size: int) -> GpuJob:
    return twilight_job(evening(-2.0), size)[0]


def _moonlit(size: int) -> GpuJob:
    asked = moonlit_night().gpu_background(size, "rgba32f")
    assert asked is not None
    return asked[0]


@lru_cache(maxsize=1)
def moonlit_night() -> SkyAtNight:
    """A full moon at 40 degrees, the sun at -10, and a glow."""
    sun, moon = evening(-10.0), replace(evening(40.0), visible_disc_fraction=1.0)
    ground = GroundReflectance.grey(_ALBEDO[0])
    by_sun, by_moon = (HosekWilkieLight(each, _towards(each), ground) for each in (sun, moon))
    angles = moon.apparent_elevation_rad, moon.apparent_elevation_rad
    light = MoonLight(
        place=sun_moved(_AZIMUTH_RAD, *angles, 1.0, 0.0),
        irradiance_rgb=(1e-3,) * 3,
        of_sunlight_rgb=(_FULL_MOON,) * 3,
        angular_radius_rad=0.0045,
        lit_fraction=1.0,
        waxes=True,
    )
    rng = np.random.default_rng(1)
    glow = Array((2e-7 * rng.uniform(0.5, 1.5, (45, 90, 3))).astype(np.float32))
    return SkyAtNight(by_sun, by_moon, light, glow, 1.0, "moon")


def _towards(light: Daylight) -> Vector:
    x, y, z = world_from_enu(
        direction_from_angles(light.sun_azimuth_rad, light.apparent_elevation_rad)
    ).tolist()
    return x, y, z


def cloud_job(genus: Genus, size: int) -> GpuJob:
    """A genus before an even sky, in radiance."""
    groups = -(-size // 8)
    return GpuJob(
        module="bench",
        job="clouds",
        compute_shader=_EVEN,
        uniforms={"radiance": tuple(_SKY_RGB.tolist())},
        output="cube",
        size=size,
        format="rgba32f",
        groups=(groups, groups, 6),
        then=cloud_passes((_layer(genus),), _light(), _EYE_M, size, 1.0),
    )


def sky_behind(genus: Genus, size: int) -> NDArray[np.float64]:
    """The same by the processor (6, size, size, 3)."""
    cube = np.tile(_SKY_RGB, (6, size, size, 1))
    up = texel_directions(size)[..., 1] > 0.0
    cube[up] = sky_behind_clouds((_layer(genus),), _light(), cube, up, _EYE_M)
    return cube


@lru_cache(maxsize=4)
def _layer(genus: Genus) -> CloudLayer:
    usual = TYPICAL[genus]
    size = usual.base_m, usual.thickness_m, usual.extinction_per_m
    return cloud_layer(Layer(genus, usual.coverage, *size, 0.0, 0.0), seed=1)


def _light() -> ClearLight:
    cube = np.tile(_SKY_RGB, (6, 8, 8, 1))
    return ClearLight(_SUN, _IRRADIANCE, irradiance_coefficients(cube))

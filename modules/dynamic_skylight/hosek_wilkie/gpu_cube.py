"""The Hosek-Wilkie cube map as a GPU job; the formula's numbers are its uniforms."""

import numpy as np
from numpy.typing import ArrayLike

from dynamic_skylight.hosek_wilkie.fast_formula import (
    ANGLE_POLYNOMIAL,
    EXP2M1_POLYNOMIAL,
    fold,
)
from dynamic_skylight.hosek_wilkie.formula import HORIZON_OFFSET
from dynamic_skylight.hosek_wilkie.sky import ALL_FACES, HosekWilkieSky
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.messages.gpu_job import GpuJob, TexelFormat, UniformValue, in_format
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.shader_text import floats, shader_source

# In the order of `fold`, as the shader calls them.
_NUMBERS = (
    "zenith_base", "zenith_factor", "zenith_decay", "CD", "D", "E", "F", "G", "gap", "I", "H",
)  # fmt: skip
_GROUP = 8


def gpu_cube_job(
    module: str,
    job: str,
    sky: HosekWilkieSky,
    sun_azimuth_rad: float,
    ground_rgb: ArrayLike,
    size: int,
    scale: float,
    wanted: tuple[int, ...] = ALL_FACES,
    read_back: bool = False,
    format: TexelFormat = "rgba16f",
) -> GpuJob:
    """A job that writes sky and ground (3,), divided by `scale`, to a cube of this format.

    Faces, axes and azimuth are those of `HosekWilkieSky.cube_map`. Texels of the faces that are
    not wanted are left undefined.
    """
    groups = -(-size // _GROUP)
    formula = sky.rgb_distribution, sky.rgb_mean_radiance, sky.sun_elevation_rad
    uniforms = formula_uniforms(*formula, sun_azimuth_rad, ground_rgb, scale)
    return GpuJob(
        module=module,
        job=job,
        compute_shader=in_format(formula_shader(), format),
        uniforms={**uniforms, "faces": (*wanted, *(0,) * (len(ALL_FACES) - len(wanted)))},
        output="cube",
        size=size,
        format=format,
        groups=(groups, groups, len(wanted)),
        read_back=read_back,
    )


def formula_uniforms(
    distribution: FloatArray,
    mean_radiance: FloatArray,
    sun_elevation_rad: float,
    sun_azimuth_rad: float,
    ground_rgb: ArrayLike,
    scale: float,
) -> dict[str, UniformValue]:
    """The uniforms of hosek_wilkie.comp, for all faces; the distribution is that of `HourSky`."""
    numbers = fold(distribution, mean_radiance / scale)
    sun = world_from_enu(direction_from_angles(sun_azimuth_rad, sun_elevation_rad))
    return {
        "faces": ALL_FACES,
        "sun": floats(sun),
        "ground": floats(np.asarray(ground_rgb) / scale),
        "angle_polynomial": floats(ANGLE_POLYNOMIAL),
        "exp2m1_polynomial": floats(EXP2M1_POLYNOMIAL),
        "horizon_offset": HORIZON_OFFSET,
        **{name: floats(column) for name, column in zip(_NUMBERS, numbers.T, strict=True)},
    }


def formula_shader() -> str:
    """The text of the formula's program, for half precision."""
    return shader_source("hosek_wilkie.comp", "dynamic_skylight")

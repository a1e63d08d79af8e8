"""The sky of any hour as a GPU job: the formula, twilight's map of directions over it, and night.

One program computes what `HourSky.cube_map` does in three steps.
"""

import numpy as np
from numpy.typing import ArrayLike

from dynamic_skylight.hosek_wilkie.gpu_cube import formula_shader, formula_uniforms
from dynamic_skylight.hosek_wilkie.sky import half_scale
from dynamic_skylight.twilight import HourSky
from dynamic_skylight.twilight_blend import model_on_map
from dynamic_skylight.twilight_table import MAP_SHAPE
from vrut_lite.array import Array
from vrut_lite.messages.gpu_job import GpuJob, TexelFormat, in_format
from vrut_lite.sky.shader_text import floats, shader_source

_TWILIGHT_BINDING = 1
_GROUP = 8
_MAIN = "void main()"
# Where no twilight is: the formula as it is.
_NO_TWILIGHT = np.tile(np.array([0.0, 0.0, 0.0, 1.0]), (*MAP_SHAPE, 1))


def gpu_twilight_job(
    module: str,
    job: str,
    sky: HourSky,
    sun_azimuth_rad: float,
    ground_rgb: ArrayLike,
    size: int,
    format: TexelFormat = "rgba16f",
    read_back: bool = False,
) -> tuple[GpuJob, float]:
    """A job that makes the cube map of `background.sphere`, and its scale, a power of two.

    Radiance is the texels' value times the scale; `ground_rgb` is (3,).
    """
    twilight = _NO_TWILIGHT if sky.twilight is None else sky.twilight
    scale = half_scale(max(_brightest(sky, twilight), float(np.max(ground_rgb))))
    formula = sky.distribution, sky.mean_radiance, sky.sun_elevation_rad
    nodes = (twilight / np.array([scale, scale, scale, 1.0])).astype(np.float32)
    groups = -(-size // _GROUP)
    text = formula_shader().replace(_MAIN, shader_source("twilight.glsl", __package__) + _MAIN)
    made = GpuJob(
        module=module,
        job=job,
        compute_shader=in_format(text, format),
        uniforms={
            **formula_uniforms(*formula, sun_azimuth_rad, ground_rgb, scale),
            "twilight_shape": MAP_SHAPE,
            "twilight_azimuth": floats([np.sin(sun_azimuth_rad), -np.cos(sun_azimuth_rad)]),
            "night": floats(sky.night_radiance / scale)[0],
        },
        buffers=((_TWILIGHT_BINDING, Array(nodes.reshape(-1, 4))),),
        output="cube",
        size=size,
        format=format,
        groups=(groups, groups, 6),
        read_back=read_back,
    )
    return made, scale


def _brightest(sky: HourSky, twilight: np.ndarray) -> float:
    """The largest radiance of any channel on the map's nodes, W m^-2 sr^-1.

    They hold the horizon below the sun, where a sky of a low sun is brightest.
    """
    formula = model_on_map(sky.distribution, sky.mean_radiance, sky.sun_elevation_rad)
    return float((formula * twilight[..., 3:] + twilight[..., :3]).max() + sky.night_radiance)

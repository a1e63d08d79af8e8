"""Single scattering as a job for the GPU: a cube map by any quadrature rule, without tables."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.gpu_atmosphere import atmosphere_uniforms
from bruneton_sky.quadrature import CLUSTERING, FOG_TOP, HAZE_DEPTH, unit_nodes
from bruneton_sky.rules_classical import checked_intervals
from bruneton_sky.shader_source import shader_source
from bruneton_sky.single_scattering import Rule
from vrut_lite.geometry.colour import three_sample_scale
from vrut_lite.gpu_job import GpuJob, UniformValue

MOST_GAUSS_NODES = 32
_RULE_NUMBERS: dict[str, int] = {"gauss-legendre": 0, "midpoint": 1, "trapezoid": 2, "simpson": 3}
_ALL_FACES = (0, 1, 2, 3, 4, 5)
_SKYLIGHT_EXPONENT = 3.0
_GROUP = 8


def single_scattering_cube_job(
    module: str,
    job: str,
    atmosphere: Atmosphere,
    altitude_m: float,
    sun_direction: ArrayLike,
    size: int,
    ground_rgb: ArrayLike = (0.0, 0.0, 0.0),
    rule: Rule = "gauss-legendre",
    samples: int | tuple[int, int] = 12,
    scale: float = 1.0,
    format: Literal["rgba16f", "rgba32f"] = "rgba16f",
    wanted: tuple[int, ...] = _ALL_FACES,
    read_back: bool = False,
) -> GpuJob:
    """A job that writes linear sRGB radiance over `scale` as a cube texture.

    Another atmosphere, sun, rule or number of samples is another set of uniforms to the same
    compiled shader. Of the faces that are not wanted the texels are anyone's.

    Args:
        module, job: who asks, and the job's name.
        atmosphere: with three wavelengths.
        altitude_m: of the observer, from 0 to the top of the atmosphere.
        sun_direction: unit vector (3,) to the sun, world axes.
        size: edge in texels.
        ground_rgb: radiance (3,) of the ground, linear sRGB, dimmed by the air before it.
        rule, samples: as of `single_scattering`; at most 32 nodes of `gauss-legendre`.
        scale: what the texels are divided by.
        format: of the texels.
        wanted: the faces to compute.
        read_back: whether the result is an array, not a texture.

    Raises:
        ValueError: an argument is outside its range, or the shader has no room for it.
    """
    if not 0.0 <= altitude_m <= atmosphere.top_altitude_m:
        raise ValueError(
            f"altitude_m must lie between 0 and {atmosphere.top_altitude_m:g}, not {altitude_m}"
        )
    groups = -(-size // _GROUP)
    return GpuJob(
        module=module,
        job=job,
        compute_shader=shader_source("single_scattering_cube.comp"),
        uniforms={
            **atmosphere_uniforms(atmosphere),
            **quadrature_uniforms(rule, samples),
            **_colour_uniforms(atmosphere, ground_rgb, scale),
            "observer_altitude_m": float(altitude_m),
            "sun": _floats(sun_direction),
            "half_precision": int(format == "rgba16f"),
            "faces": (*wanted, *(0,) * (len(_ALL_FACES) - len(wanted))),
        },
        output="cube",
        size=size,
        format=format,
        groups=(groups, groups, len(wanted)),
        read_back=read_back,
    )


def _colour_uniforms(
    atmosphere: Atmosphere, ground_rgb: ArrayLike, scale: float
) -> dict[str, UniformValue]:
    colour = three_sample_scale(atmosphere.wavelength_nm, _SKYLIGHT_EXPONENT)
    return {
        "sky_rgb_scale": _floats(colour / scale),
        "ground_rgb": _floats(np.asarray(ground_rgb) / scale),
    }


def quadrature_uniforms(rule: Rule, samples: int | tuple[int, int]) -> dict[str, UniformValue]:
    """Uniforms of shaders/single_scattering.glsl for a rule and its samples.

    Raises:
        ValueError: the rule is unknown, or the samples do not suit it.
    """
    intervals, count = (1, 1), 1
    if rule == "gauss-legendre":
        if not isinstance(samples, int) or not 1 <= samples <= MOST_GAUSS_NODES:
            raise ValueError(
                f"samples of gauss-legendre on the GPU must be 1 to {MOST_GAUSS_NODES}, "
                f"not {samples!r}"
            )
        count = samples
    else:
        intervals = checked_intervals(rule, samples)
    padding = (0.0,) * (MOST_GAUSS_NODES - count)
    nodes, weights = unit_nodes(count)
    return {
        "rule": _RULE_NUMBERS[rule],
        "intervals": intervals,
        "gauss_nodes": count,
        "gauss_node": _floats(nodes) + padding,
        "gauss_weight": _floats(weights) + padding,
        "clustering": (CLUSTERING, HAZE_DEPTH),
        "fog_top": FOG_TOP,
    }


def _floats(values: ArrayLike) -> tuple[float, ...]:
    return tuple(float(value) for value in np.asarray(values, dtype=float))

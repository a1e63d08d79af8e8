"""Single scattering as a job for the GPU: a cube map by any quadrature rule, without tables."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import mie_phase_parameters
from bruneton_sky.published.classical_rules import checked_intervals
from bruneton_sky.published.single_scattering import Rule
from bruneton_sky.quadrature import CLUSTERING, FOG_TOP, HAZE_DEPTH, unit_nodes
from bruneton_sky.tables.sizes import refuse_unpublished
from vrut_lite.geometry.colour import three_sample_scale
from vrut_lite.messages.gpu_job import GpuJob, UniformValue
from vrut_lite.sky.shader_text import shader_source

WAVELENGTHS, MOST_ABSORBER_NODES, MOST_GAUSS_NODES = 3, 8, 32
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
    compiled shader. Texels of faces that are not wanted are left undefined.

    Args:
        module, job: names of the asking module and of the job.
        atmosphere: with three wavelengths.
        altitude_m: of the observer, from 0 to the top of the atmosphere.
        sun_direction: unit vector (3,) to the sun, world axes.
        size: edge in texels.
        ground_rgb: radiance (3,) of the ground, linear sRGB, dimmed by the air before it.
        rule, samples: as of `single_scattering`; at most 32 nodes of `gauss-legendre`.
        scale: divisor of the texels.
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
        compute_shader=shader_source("single_scattering_cube.comp", "bruneton_sky.published"),
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


def atmosphere_uniforms(atmosphere: Atmosphere) -> dict[str, UniformValue]:
    """Uniforms of shaders/atmosphere.glsl by name, for an atmosphere with three wavelengths.

    Raises:
        ValueError: it has another number of wavelengths, more than 8 absorber nodes, or matter
            that the published method does not know.
    """
    refuse_unpublished(atmosphere)
    count = len(atmosphere.wavelength_nm)
    if count != WAVELENGTHS:
        raise ValueError(f"a shader's atmosphere needs {WAVELENGTHS} wavelengths, not {count}")
    nodes = _absorber_nodes(atmosphere)
    if nodes > MOST_ABSORBER_NODES:
        raise ValueError(
            f"a shader's atmosphere has room for {MOST_ABSORBER_NODES} absorber nodes, not {nodes}"
        )
    padding = (0.0,) * (MOST_ABSORBER_NODES - nodes)
    return {
        "ground_radius_m": atmosphere.ground_radius_m,
        "top_altitude_m": atmosphere.top_altitude_m,
        "scale_height_m": (atmosphere.rayleigh_scale_height_m, atmosphere.mie_scale_height_m),
        "solar_irradiance": atmosphere.solar_irradiance,
        "rayleigh_scattering": atmosphere.rayleigh_scattering,
        "mie_scattering": atmosphere.mie_scattering,
        "mie_extinction": atmosphere.mie_extinction,
        "fog_scattering": atmosphere.fog_scattering,
        "fog_extinction": atmosphere.fog_extinction,
        "fog_scale_height_m": atmosphere.fog_scale_height_m if atmosphere.foggy else 0.0,
        "absorption_extinction": atmosphere.absorption_extinction,
        "mie_phase": tuple(mie_phase_parameters(atmosphere)),
        "absorber_nodes": nodes,
        "absorber_altitude_m": atmosphere.absorber_altitude_m[:nodes] + padding,
        "absorber_density": atmosphere.absorber_density[:nodes] + padding,
    }


def _absorber_nodes(atmosphere: Atmosphere) -> int:
    """None without an absorber: the shaders then skip its paths."""
    absorbs = any(atmosphere.absorption_extinction) and any(atmosphere.absorber_density)
    return len(atmosphere.absorber_altitude_m) if absorbs else 0


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

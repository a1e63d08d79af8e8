"""A sky-view table on the GPU: its cube map as a job, and a shader that shows it pixel by pixel."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.sky_view.table import AerosolBands, SkyView, level_direction
from bruneton_sky.sun_light import DiscLight
from vrut_lite.array import Array
from vrut_lite.geometry.encoding import float16_scale
from vrut_lite.messages.gpu_job import GpuJob, GpuPass, TexelFormat, in_format
from vrut_lite.messages.sky import ViewShader
from vrut_lite.numeric_types import Number
from vrut_lite.sky.shader_text import floats, shader_source

PACKAGE = "bruneton_sky"
NODES_BINDING, _SUNLIGHT_BINDING, BANDS_BINDING = 1, 2, 3
_GROUP = 8
ALL_FACES = (0, 1, 2, 3, 4, 5)
Uniforms = dict[str, Number | tuple[Number, ...]]


def sky_view_job(
    view: SkyView,
    size: int,
    ground_radiance_rgb: ArrayLike,
    module: str,
    job: str,
    wanted: tuple[int, ...] = ALL_FACES,
    read_back: bool = False,
    format: TexelFormat = "rgba16f",
) -> tuple[GpuJob, float]:
    """A job that makes the cube map of `fill_cube`, and its scale.

    Radiance is the texels' value times the scale, a power of two.

    Args:
        view: the table.
        size: edge in texels.
        ground_radiance_rgb: (3,), below the horizon where the table has no rows there.
        module, job: names of the module that asks and of the job.
        wanted: the faces to compute; texels of the others are left undefined.
        read_back: whether the result is an array, not a texture.
        format: of the texels.
    """
    scale = cube_scale(view, ground_radiance_rgb)
    last = cube_pass(
        look_up_uniforms(view.shape, view.depth, view.sun_direction), _table_buffers(view), size,
        ground_radiance_rgb, scale, wanted, format,
    )  # fmt: skip
    made = GpuJob(
        module=module,
        job=job,
        compute_shader=last.compute_shader,
        uniforms=last.uniforms,
        buffers=last.buffers,
        output="cube",
        size=size,
        format=format,
        groups=last.groups,
        read_back=read_back,
    )
    return made, scale


def cube_pass(
    look_up: Uniforms,
    buffers: tuple[tuple[int, Array], ...],
    size: int,
    ground_radiance_rgb: ArrayLike,
    scale: float,
    wanted: tuple[int, ...] = ALL_FACES,
    format: TexelFormat = "rgba32f",
) -> GpuPass:
    """The program that writes the cube of a table; `look_up` and `buffers` are sky_view.glsl's."""
    groups = -(-size // _GROUP)
    return GpuPass(
        compute_shader=in_format(shader_source("sky_view_cube.comp", PACKAGE), format),
        uniforms={
            **look_up,
            "ground": floats(ground_radiance_rgb),
            "inverse_scale": 1.0 / scale,
            "faces": (*wanted, *(0,) * (len(ALL_FACES) - len(wanted))),
        },
        buffers=buffers,
        groups=(groups, groups, len(wanted)),
    )


def cube_scale(view: SkyView, ground_radiance_rgb: ArrayLike) -> float:
    """The power of two by which a table's cube fits half precision."""
    return float16_scale(_brightest(view, ground_radiance_rgb))


def _brightest(view: SkyView, ground: ArrayLike) -> float:
    """An upper bound of the texels, near the brightest.

    Where the table has no rows below the horizon, a sun below it is never looked at.
    """
    phased, bands = view.nodes.reshape(-1, 2, 4).max(axis=0).astype(float) ** 4
    height = float(view.sun_direction[1])
    seen = view.shape[1] > 0 or height >= 0.0
    nearest = 1.0 if seen else np.sqrt((1.0 - height) * (1.0 + height))
    first = int(np.sqrt(0.5 - 0.5 * nearest) * (len(view.bands.phase) - 1))
    aerosol = bands * view.bands.phase[first:].max(axis=0) @ np.maximum(view.bands.colour, 0.0)
    return float(max(np.max(phased[:3] + aerosol[:3]), np.max(np.asarray(ground, dtype=float))))


def view_shader(view: SkyView, disc: DiscLight) -> ViewShader:
    """The shader of the observer's sky, with the sun's disc behind the air.

    The table must have rows below the horizon.
    """
    look_up = look_up_uniforms(view.shape, view.depth, view.sun_direction)
    return shader_of_table(look_up, view.depth, _table_buffers(view), disc)


def shader_of_table(
    look_up: Uniforms,
    depth: NDArray[np.float64],
    buffers: tuple[tuple[int, Array], ...],
    disc: DiscLight,
    programs: tuple[GpuPass, ...] = (),
    shared: tuple[tuple[int, int], ...] = (),
) -> ViewShader:
    """The shader of `view_shader` for a table in `buffers`, or one that `programs` make."""
    roots = np.zeros((len(disc.irradiance_rgb), 4), np.float32)
    roots[:, :3] = disc.irradiance_rgb**0.25
    return ViewShader(
        source=shader_source("sky_view_background.glsl", PACKAGE),
        uniforms={
            **look_up,
            # The difference, because 1 + mu would lose digits in float32.
            "background_disc": floats(disc.depth[[0, -1]] - np.float32(depth[0])),
        },
        buffers=(*buffers, (_SUNLIGHT_BINDING, Array(roots))),
        programs=programs,
        shared=shared,
    )


def look_up_uniforms(
    shape: tuple[int, int, int], depth: ArrayLike, sun_direction: NDArray[np.float64]
) -> Uniforms:
    """The uniforms of sky_view.glsl, of a table's `SkyView` fields."""
    return {
        "background_shape": shape,
        "background_horizon": floats(depth),
        "background_sun": floats(sun_direction),
        "background_sun_azimuth": floats(level_direction(sun_direction)),
    }


def _table_buffers(view: SkyView) -> tuple[tuple[int, Array], ...]:
    """The storage buffers of sky_view.glsl and their bindings."""
    return (NODES_BINDING, Array(view.nodes.view())), (BANDS_BINDING, bands_array(view.bands))


def bands_array(bands: AerosolBands) -> Array:
    """The buffer `BackgroundBands` of sky_view.glsl."""
    return Array(np.concatenate([bands.colour, bands.phase]))

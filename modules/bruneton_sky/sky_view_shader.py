"""A sky-view table as shaders read it, and the shader that shows it pixel by pixel."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.shader_source import shader_source
from bruneton_sky.sky_view import SkyView, level_direction
from bruneton_sky.sun_light import DiscLight
from vrut_lite.array import Array
from vrut_lite.daylight.sky import ViewShader
from vrut_lite.numeric_types import Number

_NODES_BINDING, _SUNLIGHT_BINDING = 1, 2


def view_shader(view: SkyView, disc: DiscLight) -> ViewShader:
    """What the table's observer sees, and the sun's disc through the air before it.

    The table must have rows below the horizon.
    """
    roots = np.zeros((len(disc.irradiance_rgb), 4), np.float32)
    roots[:, :3] = disc.irradiance_rgb**0.25
    return ViewShader(
        source=shader_source("sky_view_background.glsl"),
        uniforms={
            **look_up_uniforms(view),
            # Of the difference float32 keeps all digits, of 1 + mu it would not.
            "background_disc": floats(disc.depth[[0, -1]] - np.float32(view.depth[0])),
        },
        buffers=(nodes_buffer(view), (_SUNLIGHT_BINDING, Array(roots))),
    )


def look_up_uniforms(view: SkyView) -> dict[str, Number | tuple[Number, ...]]:
    """The uniforms of sky_view.glsl."""
    g, factor, form = view.phase
    return {
        "background_shape": view.shape,
        "background_horizon": floats(view.depth),
        "background_sun": floats(view.sun_direction),
        "background_sun_azimuth": floats(level_direction(view.sun_direction)),
        "background_phase": floats((factor, form, (1.0 - g) ** 2, 2.0 * g)),
    }


def nodes_buffer(view: SkyView) -> tuple[int, Array]:
    """The storage buffer of sky_view.glsl and its binding."""
    return _NODES_BINDING, Array(view.nodes.view())


def floats(values: ArrayLike | NDArray[np.float64]) -> tuple[float, ...]:
    """Numbers as the shader reads them.

    A last bit of float64, which processors differ in, would change a job's recipe.
    """
    return tuple(float(value) for value in np.asarray(values, dtype=np.float32))

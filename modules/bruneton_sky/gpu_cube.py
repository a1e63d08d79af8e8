"""A sky-view table's cube map as a job for the GPU: the table goes up, the cube stays there."""

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.phase import MiePhase
from bruneton_sky.shader_source import shader_source
from bruneton_sky.sky_view import SkyView
from bruneton_sky.sky_view_shader import floats, look_up_uniforms, nodes_buffer
from vrut_lite.geometry.encoding import float16_scale
from vrut_lite.gpu_job import GpuJob

_GROUP = 8
_ALL_FACES = (0, 1, 2, 3, 4, 5)


def sky_view_job(
    view: SkyView,
    size: int,
    ground_radiance_rgb: ArrayLike,
    module: str,
    job: str,
    wanted: tuple[int, ...] = _ALL_FACES,
    read_back: bool = False,
) -> tuple[GpuJob, float]:
    """A job that makes the cube map of `fill_cube` in half precision, and its scale.

    Radiance is the texels' value times the scale, a power of two.

    Args:
        view: the table.
        size: edge in texels.
        ground_radiance_rgb: (3,), below the horizon where the table has no rows there.
        module, job: who asks, and the job's name.
        wanted: the faces to compute; of the others the texels are anyone's.
        read_back: whether the result is an array, not a texture.
    """
    scale = float16_scale(_brightest(view, ground_radiance_rgb))
    groups = -(-size // _GROUP)
    made = GpuJob(
        module=module,
        job=job,
        compute_shader=shader_source("sky_view_cube.comp"),
        uniforms={
            **look_up_uniforms(view),
            "ground": floats(ground_radiance_rgb),
            "inverse_scale": 1.0 / scale,
            "faces": (*wanted, *(0,) * (len(_ALL_FACES) - len(wanted))),
        },
        buffers=(nodes_buffer(view),),
        output="cube",
        size=size,
        groups=(groups, groups, len(wanted)),
        read_back=read_back,
    )
    return made, scale


def _brightest(view: SkyView, ground: ArrayLike) -> float:
    """No texel is brighter, nor the brightest much darker.

    From where the table has no rows below the horizon, a sun there is never looked at.
    """
    phased, mie = view.nodes.reshape(-1, 2, 4)[..., :3].max(axis=0).astype(float) ** 4
    height = float(view.sun_direction[1])
    seen = view.shape[1] > 0 or height >= 0.0
    nearest = 1.0 if seen else np.sqrt((1.0 - height) * (1.0 + height))
    phase = max(_mie_phase(view.phase, nu) for nu in (nearest, -1.0))
    return float(max(np.max(phased + phase * mie), np.max(np.asarray(ground, dtype=float))))


def _mie_phase(phase: MiePhase, nu: float) -> float:
    g, factor, form = phase
    return float(factor * (1.0 + form * nu * nu) / ((1.0 - g) ** 2 + 2.0 * g * (1.0 - nu)) ** 1.5)

"""The same rules as a compute shader: time per ray against error with OpenGL.

The rays are the texels of a cube map's upper face, 35 to 90 degrees up, three wavelengths, in
single precision, which leaves relative errors of about 1e-6.
"""

import time
from collections.abc import Callable
from functools import partial
from typing import Any, cast

import numpy as np
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.published.gpu_single_scattering import (
    MOST_GAUSS_NODES,
    single_scattering_cube_job,
)
from bruneton_sky.published.single_scattering import Rule

from vrut_lite.geometry.colour import three_sample_scale
from vrut_lite.geometry.cube_map import FACE_NORMALS, texel_directions
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.numeric_types import FloatArray
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite_lab.bench.gl import clock_name, has_timer
from vrut_lite_lab.study.rules.against_truth import NODES, SAMPLES, Samples, all_rules, truth
from vrut_lite_lab.study.rules.airs import SeaLevelRays
from vrut_lite_lab.study.rules.run_times import RunTime

SIZE = 16
# After some 32,800 rounds of all its loops Mesa's software renderer ends a shader's loops: at
# 256 x 128 the last nodes are missing, at 512 x 256 most of them.
_LLVMPIPE_ROUNDS = 32_000
# A graphics card at rest runs slowly at first: a shader is timed at least so long and so often.
_WARM_S, _ROUNDS = 0.3, 7
_UP = int(np.flatnonzero(FACE_NORMALS[:, 1] > 0.5)[0])


def shader_run_times(
    air: Atmosphere,
    sun_zenith_deg: float,
    samples: tuple[tuple[int, int], ...] = SAMPLES,
    nodes: tuple[int, ...] = NODES,
    size: int = SIZE,
) -> tuple[str, list[RunTime]]:
    """The device and clock in words, and the times.

    Args:
        air: of three wavelengths.
        sun_zenith_deg: below 90.
        samples, nodes: of the textbook rules and of ours.
        size: edge of the face in texels, a multiple of 8.

    Raises:
        UserError: there is no OpenGL here.
    """
    owner = GlOwner()
    try:
        device = f"GLSL on {owner.opened.renderer.split(' (')[0]}"
        clock = clock_name(owner.opened.renderer)
        most = np.inf if has_timer(owner.opened.renderer) else _LLVMPIPE_ROUNDS
        known = [(rule, n) for rule, n in all_rules(samples, nodes) if _can(rule, n, most)]
        timed = [
            owner.call(partial(_timed, air=air, sun=sun_zenith_deg, rule=rule, taken=n, size=size))
            for rule, n in known
        ]
    finally:
        owner.close()
    rows = [
        RunTime(device, sun_zenith_deg, rule, taken, ns, rms)
        for (rule, taken), (ns, rms) in zip(known, timed, strict=True)
    ]
    return f"{device}, {clock}", rows


def _can(rule: str, samples: Samples, most_rounds: float) -> bool:
    """Whether the shader has this rule with that number of samples."""
    if isinstance(samples, int):
        return samples <= MOST_GAUSS_NODES
    return rule != "simpson-trapezoid" and (samples[0] + 1) * (samples[1] + 1) <= most_rounds


def _timed(
    context: Any,
    air: Atmosphere,
    sun: float,
    rule: str,
    taken: Samples,
    size: int,
) -> tuple[float, float]:
    """Nanoseconds per ray, and the relative error."""
    zenith = np.radians(sun)
    toward = np.array([0.0, np.cos(zenith), -np.sin(zenith)])
    job = single_scattering_cube_job(
        "study",
        "cube",
        air,
        0.0,
        toward,
        size,
        rule=cast(Rule, rule),
        samples=taken,
        format="rgba32f",
        wanted=(_UP,),
    )
    texture = context.texture_cube((size, size), 4, dtype="f4")
    program = _program(context, job)
    texture.bind_to_image(0, read=False, write=True)
    spent = _least_s(context, lambda: program.run(*job.groups))
    context.memory_barrier()
    texels = np.frombuffer(texture.read(_UP), dtype=np.float32).reshape(size, size, 4)
    for part in (texture, program):
        part.release()
    return 1e9 * spent / size**2, _error(air, toward, texels[..., :3].astype(float))


def _least_s(context: Any, work: Callable[[], Any]) -> float:
    """The shortest of many rounds of GPU work, in seconds."""
    by_query = has_timer(context.info["GL_RENDERER"])
    end_s = time.perf_counter() + _WARM_S
    spent: list[float] = []
    while len(spent) < _ROUNDS or time.perf_counter() < end_s:
        query = context.query(time=True)
        start_s = time.process_time()
        with query:
            work()
        context.finish()
        spent.append(query.elapsed * 1e-9 if by_query else time.process_time() - start_s)
    return min(spent)


def _program(context: Any, job: GpuJob) -> Any:
    program = context.compute_shader(job.compute_shader)
    for name, value in job.uniforms.items():
        if name in program:
            program[name].value = value
    return program


def _error(air: Atmosphere, toward: FloatArray, texels: FloatArray) -> float:
    face = texel_directions(len(texels))[_UP].reshape(-1, 3)
    rays = SeaLevelRays(face[:, 1], float(toward[1]), np.clip(face @ toward, -1.0, 1.0))
    radiance = texels.reshape(-1, 3) / three_sample_scale(air.wavelength_nm, 3.0)
    return float(np.sqrt(((radiance / truth(air, rays) - 1.0) ** 2).mean()))

"""The GPU's cube map, timed on whatever OpenGL there is."""

import time
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from dynamic_skylight.hosek_wilkie.gpu_cube import gpu_cube_job
from dynamic_skylight.hosek_wilkie.sky import half_scale

from vrut_lite.kernel.gpu_job import GpuJob
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite_bench.hosek_wilkie_paths import AZIMUTH_RAD, SKY, error_of, exact_cube

ROUNDS = 7
GROUND = (0.0, 0.0, 0.0)


class GpuTimes(NamedTuple):
    """The renderer, how it was timed, seconds by size, and the error at 256 texels."""

    renderer: str
    clock: str
    seconds: dict[int, float]
    error: float


def measure(sizes: tuple[int, ...]) -> GpuTimes:
    """The job's shader into a texture that is kept; without the transfer of anything.

    By timer query; llvmpipe's does not see compute shaders, so there it is the CPU time of all
    its threads until everything is finished.
    """
    owner = GlOwner()
    by_query = not owner.renderer.startswith("llvmpipe")
    seconds = {size: owner.call(partial(_least, size=size, by_query=by_query)) for size in sizes}
    error = owner.call(_error)
    owner.close()
    clock = "timer query" if by_query else "CPU time of all threads"
    return GpuTimes(owner.renderer.split(" (")[0], clock, seconds, error)


def _prepared(context: Any, size: int) -> tuple[Any, Any, GpuJob]:
    scale = half_scale(SKY.brightest)
    job = gpu_cube_job("bench", "cube", SKY, AZIMUTH_RAD, GROUND, size, scale)
    program = context.compute_shader(job.compute_shader)
    for name, value in job.uniforms.items():
        program[name].value = value
    texture = context.texture_cube((size, size), 4, dtype="f2")
    texture.bind_to_image(0, read=False, write=True)
    return program, texture, job


def _least(context: Any, size: int, by_query: bool) -> float:
    program, texture, job = _prepared(context, size)
    spent = []
    for _ in range(ROUNDS):
        query = context.query(time=True)
        start = time.process_time()
        with query:
            program.run(*job.groups)
        context.finish()
        elapsed = query.elapsed * 1e-9
        spent.append(elapsed if by_query else time.process_time() - start)
    texture.release()
    return min(spent)


def _error(context: Any) -> float:
    program, texture, job = _prepared(context, 256)
    program.run(*job.groups)
    context.memory_barrier()
    faces = [np.frombuffer(texture.read(face), np.float16) for face in range(6)]
    cube = np.stack(faces).reshape(6, 256, 256, 4)[..., :3].astype(float)
    texture.release()
    return error_of(cube * half_scale(SKY.brightest), exact_cube(256))

"""Work on whatever OpenGL there is, timed by a clock that can be trusted there."""

import time
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.gpu_job import GpuJob
from vrut_lite.render.gl_environment import probe_gl
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite_bench.gpu_clock import clock_name, has_timer
from vrut_lite_bench.path import WALL_TIME, Clock, Spent, Work, cpu_spent


@lru_cache(maxsize=1)
def gl_owner() -> GlOwner:
    """The owner that all of a run share.

    Raises:
        UserError: there is no OpenGL here.
    """
    return GlOwner()


_CLOSERS: list[Callable[[], None]] = []


def on_close(close: Callable[[], None]) -> None:
    """Have something closed at the end, before the owner."""
    _CLOSERS.append(close)


def close_gl() -> None:
    """Give back what a run made."""
    while _CLOSERS:
        _CLOSERS.pop(0)()
    if gl_owner.cache_info().currsize:
        gl_owner().close()
    gl_owner.cache_clear()


def missing_gl() -> str:
    """Why there is no OpenGL; nothing where there is."""
    name, reason = probe_gl()
    return "" if name else f"no OpenGL 4.3 through EGL ({reason})"


def renderer() -> str:
    """Which OpenGL, in short."""
    return probe_gl()[0].split(" (")[0] or "none"


def gl_clock() -> Clock:
    """By timer query; where that sees nothing, CPU time of all threads until all is finished."""
    name = probe_gl()[0]
    return Clock(clock_name(name), _by_query if has_timer(name) else cpu_spent)


def gl_read_back_clock() -> Clock:
    """For work whose results are read back: wall time, or CPU time where the CPU does it all."""
    name = probe_gl()[0]
    return WALL_TIME if has_timer(name) else gl_clock()


def _by_query(work: Work) -> Spent:
    wall_s = time.perf_counter()
    result = work()
    return Spent(result, float(result.gpu_s), time.perf_counter() - wall_s)


class GlCube:
    """A job's shader, run again and again into one texture that is kept.

    `scale` is what texels are multiplied by when they are read.
    """

    def __init__(self, job: GpuJob, scale: float = 1.0):
        self.gpu_s = 0.0
        self._job, self._scale = job, scale
        gl_owner().call(self._prepare)

    def _prepare(self, context: Any) -> None:
        job = self._job
        self._program = context.compute_shader(job.compute_shader)
        for name, value in job.uniforms.items():
            if name in self._program:
                self._program[name].value = value
        self._buffers = {
            binding: context.buffer(array.values.tobytes()) for binding, array in job.buffers
        }
        kind = "f2" if job.format == "rgba16f" else "f4"
        self._texture = context.texture_cube((job.size, job.size), 4, dtype=kind)

    def __call__(self) -> "GlCube":
        """Run it, and wait until it is done."""
        gl_owner().call(self._run)
        return self

    def _run(self, context: Any) -> None:
        self._texture.bind_to_image(0, read=False, write=True)
        for binding, buffer in self._buffers.items():
            buffer.bind_to_storage_buffer(binding)
        query = context.query(time=True)
        with query:
            self._program.run(*self._job.groups)
        context.finish()
        self.gpu_s = query.elapsed * 1e-9

    def read(self) -> NDArray[np.float64]:
        """The cube (6, size, size, 3)."""
        return self._scale * gl_owner().call(self._read)

    def _read(self, context: Any) -> NDArray[np.float64]:
        context.memory_barrier()
        kind = np.float16 if self._job.format == "rgba16f" else np.float32
        faces = [np.frombuffer(self._texture.read(face), kind) for face in range(6)]
        cube = np.stack(faces).reshape(6, *self._texture.size, 4)
        return cube[..., :3].astype(float)


class GlCubes:
    """Some cubes, one after another."""

    def __init__(self, cubes: list[GlCube]):
        self.cubes = cubes
        self.gpu_s = 0.0

    def __call__(self) -> "GlCubes":
        """Run them all."""
        self.gpu_s = sum(cube().gpu_s for cube in self.cubes)
        return self

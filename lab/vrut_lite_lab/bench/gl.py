"""OpenGL work, timed by a clock that is valid for the renderer.

On a graphics card work is timed by timer queries. llvmpipe, which draws on the CPU, does not count
compute shaders in them: there it is the CPU time of all threads until everything is finished.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.gpu_job import GpuJob, GpuPass
from vrut_lite.render.gl_environment import probe_gl
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite_lab.bench.bench_path import WALL_TIME, Spent, Work, WorkClock, cpu_spent

_CLOSERS: list[Callable[[], None]] = []


@lru_cache(maxsize=1)
def gl_owner() -> GlOwner:
    """The owner that all of a run share.

    Raises:
        UserError: there is no OpenGL here.
    """
    return GlOwner()


def on_close(close: Callable[[], None]) -> None:
    """Have something closed at the end, before the owner."""
    _CLOSERS.append(close)


def close_gl() -> None:
    """Close all that a run made."""
    while _CLOSERS:
        _CLOSERS.pop(0)()
    if gl_owner.cache_info().currsize:
        gl_owner().close()
    gl_owner.cache_clear()


def missing_gl() -> str:
    """Why there is no OpenGL; empty where there is."""
    name, reason = probe_gl()
    return "" if name else f"no OpenGL 4.3 through EGL ({reason})"


def renderer() -> str:
    """Which OpenGL, in short."""
    return probe_gl()[0].split(" (")[0] or "none"


def has_timer(renderer: str) -> bool:
    """Whether timer queries see compute shaders; llvmpipe's do not."""
    return not renderer.startswith("llvmpipe")


def clock_name(renderer: str) -> str:
    """Name of the clock of GPU work."""
    return "timer query" if has_timer(renderer) else "CPU time of all threads"


def gl_clock() -> WorkClock:
    """The clock of a `GlWork`."""
    name = probe_gl()[0]
    return WorkClock(clock_name(name), _by_query if has_timer(name) else cpu_spent)


def gl_read_back_clock() -> WorkClock:
    """For work whose results are read back: wall time, or CPU time where the CPU does it all."""
    return WALL_TIME if has_timer(probe_gl()[0]) else gl_clock()


def _by_query(work: Work) -> Spent:
    wall_s = time.perf_counter()
    result = work()
    return Spent(result, float(result.gpu_s), time.perf_counter() - wall_s)


class GlWork:
    """Work that is prepared once, on the GL thread, and run again and again.

    `gpu_s` is the last run's time by timer query.
    """

    def __init__(self, prepare: Callable[[Any], Callable[[], Any]]):
        self.gpu_s = 0.0
        self._work = gl_owner().call(prepare)

    def __call__(self) -> Self:
        """Run it, and wait until it is done."""
        gl_owner().call(self._run)
        return self

    def _run(self, context: Any) -> None:
        query = context.query(time=True)
        with query:
            self._work()
        context.finish()
        self.gpu_s = query.elapsed * 1e-9


class GlTexture(GlWork):
    """A job's programs, run again and again into one texture, of a cube or of three dimensions.

    `scale` multiplies texels when they are read; `reads` made the texture that the job reads.
    """

    def __init__(self, job: GpuJob, scale: float = 1.0, reads: "GlTexture | None" = None):
        self._job, self._scale, self._reads = job, scale, reads
        super().__init__(self._prepare)

    def _prepare(self, context: Any) -> Callable[[], None]:
        job = self._job
        images = [_texture(context, job) for _ in range(1 + job.scratch)]
        self._texture, *scratch = images
        steps = [_prepared(context, step) for step in job.programs]
        shared = [(binding, context.buffer(reserve=4 * count)) for binding, count in job.shared]

        def work() -> None:
            self._texture.bind_to_image(0, read=True, write=True)
            if self._reads is not None:
                self._reads._texture.bind_to_image(1, read=True, write=False)
            for unit, image in enumerate(scratch, 2):
                image.bind_to_image(unit, read=True, write=True)
            for binding, buffer in shared:
                buffer.bind_to_storage_buffer(binding)
            for number, (program, values, buffers, groups) in enumerate(steps):
                if number > 0:
                    context.memory_barrier()
                for name, value in values.items():
                    program[name].value = value
                for binding, buffer in buffers.items():
                    buffer.bind_to_storage_buffer(binding)
                program.run(*groups)

        return work

    def read(self) -> NDArray[np.float64]:
        """The cube (6, size, size, 3), or the volume (depth, height, width, 3)."""
        return self._scale * gl_owner().call(self._read)

    def _read(self, context: Any) -> NDArray[np.float64]:
        context.memory_barrier()
        kind = np.float16 if self._job.format == "rgba16f" else np.float32
        size = self._job.size
        if isinstance(size, tuple):
            texels = np.frombuffer(self._texture.read(), kind).reshape(*reversed(size), 4)
        else:
            faces = [np.frombuffer(self._texture.read(face), kind) for face in range(6)]
            texels = np.stack(faces).reshape(6, size, size, 4)
        return texels[..., :3].astype(float)


def _texture(context: Any, job: GpuJob) -> Any:
    kind = "f2" if job.format == "rgba16f" else "f4"
    if isinstance(job.size, tuple):
        return context.texture3d(job.size, 4, dtype=kind)
    return context.texture_cube((job.size, job.size), 4, dtype=kind)


def _prepared(context: Any, step: GpuPass) -> tuple[Any, dict[str, Any], dict[int, Any], Any]:
    """The program, the values that it reads, its buffers by binding, and its groups."""
    program = context.compute_shader(step.compute_shader)
    values = {name: value for name, value in step.uniforms.items() if name in program}
    sent = {binding: context.buffer(array.values.tobytes()) for binding, array in step.buffers}
    return program, values, sent, step.groups


class GlTextures:
    """Some textures, one after another."""

    def __init__(self, textures: list[GlTexture]):
        self.textures = textures
        self.gpu_s = 0.0

    def __call__(self) -> "GlTextures":
        """Run them all."""
        for texture in self.textures:
            texture()
        self.gpu_s = sum(texture.gpu_s for texture in self.textures)
        return self


class PassTimer:
    """Keeps the seconds of each pass in the last frame; used on the GL thread."""

    def __init__(self, context: Any):
        self._context = context
        self._by_query = has_timer(context.info["GL_RENDERER"])
        self.spent: dict[str, float] = {}

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        """Time the block."""
        if self._by_query:
            query = self._context.query(time=True)
            with query:
                yield
            self.spent[name] = query.elapsed * 1e-9
            return
        self._context.finish()
        start_s = time.process_time()
        yield
        self._context.finish()
        self.spent[name] = time.process_time() - start_s

"""The host module that runs GpuJobs on the GL owner and returns results as inputs."""

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import numpy as np

from vrut_lite import __version__
from vrut_lite.kernel.array import Array
from vrut_lite.kernel.gpu_job import GpuJob
from vrut_lite.kernel.messages import Input, JobResult
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.render.gl_owner import GlOwner

_DTYPES = {"rgba16f": "f2", "rgba32f": "f4"}


class GlJobs(Module):
    """Queues each GpuJob on the GL thread; at most one texture per job is kept."""

    manifest = Manifest(name="gl_jobs", title="GPU jobs", version=__version__)

    def __init__(self, link: Link, settings: Any, owner: GlOwner, inject: Callable[[Input], None]):
        super().__init__(link, settings)
        self._owner = owner
        self._inject = inject
        self._textures: dict[str, tuple[tuple[str, int, str], Any]] = {}
        self._programs: dict[str, Any] = {}
        self.pending: list[Future[None]] = []

    @handles(GpuJob)
    def on_job(self, job: GpuJob) -> None:
        """Queue it; a failure (a shader that does not compile, say) is a result too."""
        self.pending = [future for future in self.pending if not future.done()]
        self.pending.append(self._owner.submit(lambda context: self._run(context, job)))
        self.ledger.did("gpu job")

    def _run(self, context: Any, job: GpuJob) -> None:
        try:
            value, error = self._compute(context, job), ""
        except Exception as failure:
            value, error = None, f"{type(failure).__name__}: {failure}"
        self._inject(JobResult(module=job.module, job=job.job, value=value, error=error))

    def _compute(self, context: Any, job: GpuJob) -> Any:
        texture = self._texture(context, job)
        if job.compute_shader not in self._programs:
            self._programs[job.compute_shader] = context.compute_shader(job.compute_shader)
        program = self._programs[job.compute_shader]
        for name, value in job.uniforms.items():
            # A uniform that the compiler found unused is not an error.
            if name in program:
                program[name].value = value
        texture.bind_to_image(0, read=False, write=True)
        program.run(*job.groups)
        context.memory_barrier()
        return Array(_read(texture, job)) if job.read_back else texture.glo

    def _texture(self, context: Any, job: GpuJob) -> Any:
        """The job's texture, made anew when its kind or size has changed."""
        kind = (job.output, job.size, job.format)
        old_kind, texture = self._textures.get(job.key(), (None, None))
        if old_kind != kind:
            if texture is not None:
                texture.release()
            make = context.texture_cube if job.output == "cube" else context.texture
            texture = make((job.size, job.size), 4, dtype=_DTYPES[job.format])
            self._textures[job.key()] = (kind, texture)
        return texture


def _read(texture: Any, job: GpuJob) -> np.ndarray:
    dtype = np.dtype(_DTYPES[job.format])
    shape = (job.size, job.size, 4)
    if job.output == "2d":
        return np.frombuffer(texture.read(), dtype).reshape(shape).astype(np.float32)
    faces = [np.frombuffer(texture.read(face), dtype).reshape(shape) for face in range(6)]
    return np.stack(faces).astype(np.float32)

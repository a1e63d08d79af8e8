"""The host module that runs GpuJobs on the GL owner and returns results as inputs."""

from collections import defaultdict
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import numpy as np

from vrut_lite import __version__
from vrut_lite.array import Array
from vrut_lite.kernel.messages import Demand, Input, JobResult
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.render.compute_programs import ComputePrograms
from vrut_lite.render.context_loss import loss
from vrut_lite.render.device import Device
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.render.job_buffers import JobBuffers
from vrut_lite.render.texture_pool import NUMPY_TYPES, TexturePool

NAME = "gl_jobs"


class GlJobs(Module):
    """Queues each GpuJob on the GL thread.

    Its demand for GpuJobs lets modules know that GPU jobs are possible, the renderer's trial
    whether they are quick. The counters count completed jobs, and jobs skipped for a later one of
    the same key.
    """

    manifest = Manifest(name=NAME, title="GPU jobs", version=__version__)

    def __init__(self, link: Link, settings: Any, owner: GlOwner, inject: Callable[[Input], None]):
        super().__init__(link, settings)
        self._owner = owner
        self._inject = inject
        # A pool for each job: alternating jobs would release each other's textures.
        self._pools: defaultdict[str, TexturePool] = defaultdict(TexturePool)
        self._buffers = JobBuffers()
        self._programs = ComputePrograms()
        self._latest: dict[str, GpuJob] = {}
        # Jobs whose result was not sent, by identity: two of one key may be under way.
        self._unanswered: dict[int, GpuJob] = {}
        self.pending: list[Future[None]] = []
        self._tried = _tried(owner.opened.device)
        inject(self._tried)
        inject(Demand(consumer=NAME, message=GpuJob.__name__))
        owner.on_reset(self._rebuild)

    @handles(GpuJob)
    def on_job(self, job: GpuJob) -> None:
        """Queue a job; a failure, such as a shader that does not compile, is a result too."""
        self._latest[job.key()] = self._unanswered[id(job)] = job
        self.pending = [future for future in self.pending if not future.done()]
        self.pending.append(self._owner.submit(lambda context: self._run(context, job)))

    def _run(self, context: Any, job: GpuJob) -> None:
        if self._latest[job.key()] is not job:
            self._unanswered.pop(id(job), None)
            self.counters.skip("gpu job outdated")
            return
        try:
            value, error = self._compute(context, job), ""
        except Exception as failure:
            if loss(failure):
                raise
            value, error = None, f"{type(failure).__name__}: {failure}"
        if loss():
            return
        self._unanswered.pop(id(job), None)
        self.counters.did("gpu job")
        self._inject(JobResult(module=job.module, job=job.job, value=value, error=error))

    def _compute(self, context: Any, job: GpuJob) -> Array | GpuTexture:
        handle = self._pools[job.key()].take(context, job)
        self._fill(context, job, handle.opaque)
        return Array(_read(handle.opaque, job)) if job.read_back else handle

    def _fill(self, context: Any, job: GpuJob, texture: Any) -> None:
        # Lent until the end: the next job of the key may write them again.
        pool = self._pools[f"{job.key()}.scratch"]
        scratch = [pool.take(context, job) for _ in range(job.scratch)]
        name, buffers = job.key(), [step.buffers for step in job.programs]
        if kept := self._buffers.send(context, name, buffers, job.shared):
            self.counters.skip("gpu job's buffer: still there", kept)
        for number, step in enumerate(job.programs):
            texture.bind_to_image(0, read=number > 0, write=True)
            if job.reads is not None:
                job.reads.opaque.bind_to_image(1, read=True, write=False)
            for unit, image in enumerate(scratch, 2):
                image.opaque.bind_to_image(unit, read=True, write=True)
            self._buffers.bind(name, number)
            self._programs.run(context, step)

    def _rebuild(self, context: Any) -> None:
        """After a reset: compute the textures that are referred to again, and all unfinished."""
        self._buffers = JobBuffers()
        self._programs = ComputePrograms()
        # All textures first: a job reads those of another, and pools drop the lost ones.
        remade = [each for pool in self._pools.values() for each in pool.remade(context)]
        for job, texture in remade:
            self._fill(context, job, texture)
        for job in list(self._unanswered.values()):
            self.on_job(job)
        tried = _tried(self._owner.opened.device)
        if tried != self._tried:
            self._tried = tried
            self._inject(tried)


def _tried(device: Device) -> RendererTried:
    return RendererTried(
        renderer=device.renderer, trial_ns=device.trial_ns, is_software=device.is_software
    )


def _read(texture: Any, job: GpuJob) -> np.ndarray:
    dtype = np.dtype(NUMPY_TYPES[job.format])
    shape = (job.size, job.size, 4) if isinstance(job.size, int) else (*job.size[::-1], 4)
    if job.output != "cube":
        return np.frombuffer(texture.read(), dtype).reshape(shape).astype(np.float32)
    faces = [np.frombuffer(texture.read(face), dtype).reshape(shape) for face in range(6)]
    return np.stack(faces).astype(np.float32)

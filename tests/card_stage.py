"""Skies on a real kernel whose GPU jobs run by OpenGL, or that has none."""

from concurrent.futures import wait

import numpy as np

from vrut_lite.array import Array
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, Fault
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.sky import BackgroundChanged

CARD = RendererTried(renderer="a card", trial_ns=0.1)


class SkyStage:
    """A kernel of some modules; with a GL owner it has a card, whose trial the test states."""

    def __init__(self, *modules, owner=None, tried=CARD):
        self.kernel, self.owner = Kernel(), owner
        self.faults, self.jobs, self.heard = [], [], []
        self.kernel.tap(self._hear)
        for module in modules:
            self.kernel.add_module(module)
        self._runner = None
        if owner is not None:
            from vrut_lite.render.gl_jobs import GlJobs

            self.kernel.add_module(GlJobs, owner=owner, inject=self.kernel.inject)
            self._runner = self.kernel.seats["gl_jobs"].module
            # After the trial of the processor that plays the card.
            self.tell(tried)

    def _hear(self, message, _sender):
        self.heard.append(message)
        if isinstance(message, Fault):
            self.faults.append(message.error)
        elif isinstance(message, GpuJob):
            self.jobs.append(message)

    def tell(self, *messages):
        for message in messages:
            self.kernel.inject(message)
        self.settle()

    def settle(self):
        """Handle all inputs, with the results of jobs on both devices."""
        self.kernel.pump_until_idle()
        while self._runner is not None and self._runner.pending:
            wait(self._runner.pending)
            self._runner.pending = []
            self.kernel.pump_until_idle()

    def want(self, kind, size=None, encoding=""):
        self.tell(Demand(consumer="test", message=kind.__name__, size=size, encoding=encoding))

    def module(self, name):
        return self.kernel.seats[name].module

    def radiance(self, sky=None):
        """Radiance (6, n, n, 3) of a background, by default the last one posted."""
        sky = sky or self.kernel.last(BackgroundChanged)
        if isinstance(sky.cube, Array):
            return decode_float16(sky.cube.values, sky.radiance_scale).astype(float)
        return sky.radiance_scale * self.texels(sky.cube)[..., :3]

    def texels(self, texture: GpuTexture):
        """The texels (6, n, n, 4) of a texture."""
        kind = {"rgba16f": np.float16, "rgba32f": np.float32}[texture.format]
        faces = self.owner.call(lambda _: [texture.opaque.read(face) for face in range(6)])
        shape = 6, texture.size, texture.size, 4
        return np.stack([np.frombuffer(face, kind) for face in faces]).reshape(shape).astype(float)

    def close(self):
        self.kernel.close()


def apart(card, processor):
    """Largest difference over the larger of the processor's value and 1 % of its largest."""
    return float((np.abs(card - processor) / np.maximum(processor, 1e-2 * processor.max())).max())

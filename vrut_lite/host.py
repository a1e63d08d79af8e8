"""The host: a kernel with its modules, a scene manager, and the one owner of OpenGL."""

from concurrent.futures import wait

import msgspec

from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.discovery import discover
from vrut_lite.kernel.messages import (
    AmbientChanged,
    BackgroundChanged,
    ChooseSlot,
    Demand,
    Fault,
    LoadScene,
    Message,
    SunLightChanged,
)
from vrut_lite.render.gl_jobs import GlJobs
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.scene.backend import Picture, SceneBackend
from vrut_lite.scene.manager import SceneManager

# Who holds which slot unless someone chooses; a missing one falls back to load order.
DEFAULT_HOLDERS = {"sun": "dynamic_skylight", "sky": "dynamic_skylight"}
LIGHT = (BackgroundChanged, SunLightChanged, AmbientChanged)


def daylight_kernel() -> tuple[Kernel, list[str]]:
    """A kernel with every installed module, and a sentence for each that failed to load."""
    kernel = Kernel()
    modules, failures = discover()
    for module in modules:
        kernel.add_module(module)
    for slot, holder in DEFAULT_HOLDERS.items():
        if holder in kernel.slots.providers(slot):
            kernel.inject(ChooseSlot(slot=slot, module=holder))
    kernel.pump()
    return kernel, failures


def demand_light(kernel: Kernel, consumer: str, cube_size: int) -> None:
    """Ask for background, sun light and ambient, with a cube map of this size."""
    for message_type in LIGHT:
        kernel.inject(Demand(consumer=consumer, message=message_type.__name__, size=cube_size))


class FaultCollector:
    """Remembers the faults of a kernel, for those who must answer for them."""

    def __init__(self, kernel: Kernel):
        self.faults: list[Fault] = []
        kernel.tap(self._note)

    def _note(self, message: Message, sender: str) -> None:
        if isinstance(message, Fault):
            self.faults.append(message)

    def raise_first(self) -> None:
        """Raise the first fault: UserError if its maker meant the user, else ModuleFailed."""
        if not self.faults:
            return
        fault = self.faults[0]
        self.faults.clear()
        if fault.for_user:
            raise UserError(fault.error)
        raise ModuleFailed(f"module {fault.module} failed in {fault.where}: {fault.error}")


class Host:
    """Everything that a picture needs, headless; `close` gives the GPU back."""

    def __init__(self, cube_size: int = 256):
        from vrut_lite.render.pyrender_backend import PyrenderBackend

        self.gl = GlOwner()
        self.kernel, self.failures = daylight_kernel()
        self.faults = FaultCollector(self.kernel)
        self._backend = PyrenderBackend(self.gl)
        self._add_host_modules(self._backend)
        self._cube_size = cube_size
        demand_light(self.kernel, "scene", cube_size)
        self.settle()

    def _add_host_modules(self, backend: SceneBackend) -> None:
        self.kernel.add_module(GlJobs, owner=self.gl, inject=self.kernel.inject)
        self.kernel.add_module(SceneManager, backend=backend)

    def settle(self) -> None:
        """Pump until nothing is left to do, GPU jobs included.

        Raises:
            UserError: a module failed.
        """
        while True:
            self.kernel.pump()
            jobs = self.kernel.seats["gl_jobs"].module
            pending = [job for job in getattr(jobs, "pending", []) if not job.done()]
            if not pending:
                break
            wait(pending)
        self.kernel.pump()
        self.faults.raise_first()

    def inject(self, *messages: msgspec.Struct) -> None:
        """Bring inputs; `settle` or `draw` acts on them."""
        for message in messages:
            self.kernel.inject(message)  # type: ignore[arg-type]

    def load(self, path: str) -> None:
        """Open a scene; UserError if it cannot be."""
        self.inject(LoadScene(path=path))
        self.settle()

    def draw(self) -> Picture:
        """Act on all inputs and draw a frame."""
        self.settle()
        return self._backend.draw()

    def close(self) -> None:
        """Free the GPU's resources and end its thread."""
        self._backend.close()
        self.gl.close()

    def __enter__(self) -> "Host":
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

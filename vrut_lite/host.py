"""The host: a kernel with its modules, a scene manager, and the one owner of OpenGL."""

from collections.abc import Callable
from concurrent.futures import Future, wait

from numpy.typing import ArrayLike

from vrut_lite.daylight.daylight_kernel import FaultCollector, daylight_kernel, demand_light
from vrut_lite.daylight.scene import LoadScene
from vrut_lite.daylight.tolerance import tolerance_of
from vrut_lite.kernel.ledger import Ledger
from vrut_lite.kernel.messages import Input
from vrut_lite.render.frame import Measure
from vrut_lite.render.gl_jobs import GlJobs
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.render.light_meter import Illuminance
from vrut_lite.render.patience import IsGivenUp
from vrut_lite.render.pyrender_backend import PyrenderBackend
from vrut_lite.render.skips import FrameSkips
from vrut_lite.scene.backend import Picture, SceneBackend
from vrut_lite.scene.manager import SceneManager


class Host:
    """Everything that a picture needs, headless; `close` gives the GPU back.

    A `cube_size` of 1 leaves the sky's size to its module and the tolerance. `watch` may stand
    itself between the scene manager and the backend that draws. Who pumps the kernel on a thread
    of its own uses `draw_now` and `light_at_pixel`, on that thread.
    """

    def __init__(
        self, cube_size: int = 1, watch: Callable[[SceneBackend], SceneBackend] | None = None
    ):
        self.kernel, self.failures = daylight_kernel()
        self.faults = FaultCollector(self.kernel)
        self.gl = GlOwner()
        try:
            self._backend = PyrenderBackend(self.gl)
        except BaseException:
            self.gl.close()
            raise
        self.kernel.add_module(GlJobs, owner=self.gl, inject=self.kernel.inject)
        told = self._backend if watch is None else watch(self._backend)
        self.kernel.add_module(SceneManager, backend=told)
        demand_light(self.kernel, SceneManager.manifest.name, cube_size)
        self.settle()

    def settle(self) -> None:
        """Pump until no work is left, GPU jobs included.

        Raises:
            UserError: an input was invalid, such as a scene that cannot be opened.
            ModuleFailed: a module raised another exception.
        """
        while True:
            self.kernel.pump_until_idle()
            wait(self._gl_work())
            # The result of a finished GPU job is an input, which may cause more work.
            if self.kernel.pump() == 0:
                break
        self.faults.raise_first()

    def _gl_work(self) -> list[Future[None]]:
        """GPU jobs that the GL thread has not finished."""
        jobs = self.kernel.seats[GlJobs.manifest.name].module
        return list(jobs.pending) if isinstance(jobs, GlJobs) else []

    def inject(self, *messages: Input) -> None:
        """Queue inputs; `settle` or `draw` delivers them."""
        for message in messages:
            self.kernel.inject(message)

    def load(self, path: str) -> None:
        """Open a scene; UserError if it cannot be opened."""
        self.inject(LoadScene(path=path))
        self.settle()

    def draw(self, still: bool = True) -> Picture:
        """Deliver all inputs and draw a frame.

        A still is complete; in a moving frame blurred reflections may lag behind the sky.
        """
        self.settle()
        return self.draw_now(still)

    def draw_now(self, still: bool = True, is_given_up: IsGivenUp | None = None) -> Picture:
        """Draw what the scene manager knows by now.

        Raises:
            GivenUp: `is_given_up()`, asked on the GL thread again and again, said so.
        """
        self._backend.set_tolerance(tolerance_of(self.kernel))
        return self._backend.draw(still, is_given_up)

    @property
    def frame_ledger(self) -> Ledger:
        """Work that frames did and skipped since the host was made."""
        return self._backend.ledger

    @property
    def frame_skips(self) -> FrameSkips:
        """Which work frames leave out; set another to see that the picture stays."""
        return self._backend.skips

    @frame_skips.setter
    def frame_skips(self, skips: FrameSkips) -> None:
        self._backend.skips = skips

    def measure_passes(self, measure: Measure) -> None:
        """Enter `measure(name)` around each pass of a frame, on the GL thread."""
        self._backend.measure_passes(measure)

    def illuminance(self, point_m: ArrayLike, normal: ArrayLike) -> Illuminance:
        """Lux by sun and by sky on a plane with this normal (3,) at a point (3,), world axes."""
        self.settle()
        return self._backend.illuminance(point_m, normal)

    def illuminance_at_pixel(self, x: int, y: int) -> Illuminance | None:
        """Lux on the surface behind a pixel, None for the sky; y counts from the top.

        For its luminance see `draw().luminance_cd_m2(x, y)`.
        """
        self.settle()
        return self.light_at_pixel(x, y)

    def light_at_pixel(self, x: int, y: int) -> Illuminance | None:
        """The same by what the scene manager knows by now."""
        hit = self._backend.surface_at(x, y)
        return None if hit is None else self._backend.illuminance(hit.point_m, hit.normal)

    def close(self) -> None:
        """End background jobs, free the GPU's resources and end its thread."""
        self.kernel.close()
        self._backend.close()
        self.gl.close()

    def __enter__(self) -> "Host":
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

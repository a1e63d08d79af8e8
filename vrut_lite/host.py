"""The host: a kernel with its modules, a scene manager, and the one owner of OpenGL."""

from collections.abc import Sequence
from concurrent.futures import Future, wait
from dataclasses import replace

from numpy.typing import ArrayLike

from vrut_lite.daylight_kernel import FaultCollector, daylight_kernel
from vrut_lite.frame_part import Hit
from vrut_lite.kernel.jobs import JobRunner
from vrut_lite.kernel.messages import Input, JobResult
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.scene import LoadScene
from vrut_lite.pictures.picture import Picture
from vrut_lite.render.eye_pictures import EyesDrawn, HeadsetEye
from vrut_lite.render.gl_jobs import GlJobs
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.render.light_meter import Illuminance
from vrut_lite.render.picture_passes import Measure
from vrut_lite.render.pyrender_backend import PyrenderBackend
from vrut_lite.scene.backend import IsGivenUp, SceneView
from vrut_lite.scene.manager import SceneManager
from vrut_lite.scene.scene_state import FrameSkips, SceneState


class Host:
    """A kernel with all modules and a GL backend, headless; `close` frees the GPU.

    Without a `cube_size` (texels) the sky's module chooses one by the tolerance; `gl` is the host's
    from now on. `frame_skips` selects the work that frames leave out. Callers that pump the kernel
    on a separate thread use `draw_now` and `light_at_pixel`, on that thread.

    Raises:
        UserError: there is no OpenGL here.
    """

    def __init__(
        self,
        cube_size: int | None = None,
        runner: JobRunner | None = None,
        gl: GlOwner | None = None,
    ):
        self.frame_skips = FrameSkips()
        self.kernel, self.failures = daylight_kernel(runner)
        self.faults = FaultCollector(self.kernel)
        self.gl = gl or GlOwner()
        try:
            self._backend = PyrenderBackend(self.gl, self._part_failed)
        except BaseException:
            self.gl.close()
            raise
        self.kernel.add_module(GlJobs, owner=self.gl, inject=self.kernel.inject)
        self._view = SceneView(self.kernel, self._backend)
        self.kernel.add_module(SceneManager, view=self._view, cube_size=cube_size)
        self.settle()

    def _part_failed(self, name: str, work: str, error: str) -> None:
        """A frame part's failure becomes its module's Fault."""
        self.kernel.inject(JobResult(module=name, job=work, value=None, error=error))

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

    def begin_scene(self) -> None:
        """Deliver all inputs and bring the scene to the GPU while the caller goes on."""
        self.kernel.pump()
        if self.state.scene is not None:
            self._backend.begin(self.state.scene)

    def draw(self, still: bool = True) -> Picture:
        """Deliver all inputs and draw a frame.

        A still is complete; in a moving frame blurred reflections may lag behind the sky.
        """
        self.settle()
        return self.draw_now(still)

    def draw_now(self, still: bool = True) -> Picture:
        """Draw the present state."""
        return self.draw_state(self.state, still)

    def draw_state(
        self, state: SceneState, still: bool, is_given_up: IsGivenUp | None = None
    ) -> Picture:
        """Draw a state, on any thread; the kernel may be pumped meanwhile.

        Raises:
            GivenUp: `is_given_up()`, called repeatedly on the GL thread, returned true.
        """
        drawn = replace(state, skips=self.frame_skips)
        return self._backend.draw(drawn, still, is_given_up)

    def draw_eyes(self, state: SceneState, eyes: Sequence[HeadsetEye]) -> EyesDrawn:
        """Draw a state for a headset's eyes, on the GL thread; see `PyrenderBackend.draw_eyes`."""
        return self._backend.draw_eyes(replace(state, skips=self.frame_skips), eyes)

    @property
    def state(self) -> SceneState:
        """The state of the last whole revision, seen by the present camera."""
        return self._view.state

    @property
    def revision(self) -> int:
        """The number of that revision."""
        return self._view.revision

    @property
    def frame_counters(self) -> WorkCounters:
        """Work that frames did and skipped since the host was made."""
        return self._backend.counters

    def measure_passes(self, measure: Measure) -> None:
        """Enter `measure(name)` around each pass of a frame, on the GL thread."""
        self._backend.measure_passes(measure)

    def illuminance(self, point_m: ArrayLike, normal: ArrayLike) -> Illuminance:
        """Lux by sun and by sky on a plane with this normal (3,) at a point (3,), world axes."""
        self.settle()
        return self._backend.illuminance(self.state, point_m, normal)

    def illuminance_at_pixel(self, x: int, y: int) -> Illuminance | None:
        """Lux on the surface behind a pixel, None for the sky; y counts from the top.

        For its luminance see `draw().luminance_cd_m2(x, y)`.
        """
        self.settle()
        return self.light_at_pixel(x, y)

    def light_at_pixel(self, x: int, y: int) -> Illuminance | None:
        """The same for the scene manager's present state."""
        hit = self.surface_at_pixel(x, y)
        return (
            None if hit is None else self._backend.illuminance(self.state, hit.point_m, hit.normal)
        )

    def surface_at_pixel(self, x: int, y: int) -> Hit | None:
        """The surface that a pixel shows, in the scene manager's present state; None for the
        sky."""
        return self._backend.surface_at_pixel(self.state, x, y)

    def close(self) -> None:
        """End background jobs, free the GPU's resources and end its thread."""
        self.kernel.close()
        self._backend.close()
        self.gl.close()

    def __enter__(self) -> "Host":
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

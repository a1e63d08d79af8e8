"""The stage that the engine pumps and draws: with OpenGL, or without (`cpu_sky`)."""

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any, Protocol

from vrut_lite.app.engine.window_jobs import WindowJobs
from vrut_lite.frame_part import Hit
from vrut_lite.host import Host
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.pictures.picture import Picture
from vrut_lite.render.device import Device
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.render.light_meter import Illuminance
from vrut_lite.render.picture_passes import unmeasured
from vrut_lite.scene.backend import IsGivenUp
from vrut_lite.scene.scene_state import SceneState


class Stage(Protocol):
    """A kernel and a renderer; used on the engine's thread only."""

    @property
    def kernel(self) -> Kernel:
        """The kernel to pump."""

    @property
    def state(self) -> SceneState:
        """The state to draw, of one revision; a new object after each change."""

    @property
    def revision(self) -> int:
        """The number of the revision that the state shows."""

    @property
    def renderer(self) -> str:
        """The renderer's name."""

    @property
    def device(self) -> Device | None:
        """The renderer, tried out; None without OpenGL."""

    @property
    def failures(self) -> list[str]:
        """A sentence for each module that failed to load."""

    @property
    def pass_seconds(self) -> dict[str, float]:
        """Seconds of each pass of the last frame that was measured."""

    def measure_next(self) -> None:
        """Measure the next frame."""

    @property
    def frame_counters(self) -> WorkCounters:
        """Counts of work that frames did and skipped."""

    def draw(self, state: SceneState, still: bool, is_given_up: IsGivenUp | None = None) -> Picture:
        """Draw a state; GivenUp is raised when `is_given_up()`.

        One picture at a time, on any thread, also while the kernel is pumped.
        """

    def light_at_pixel(self, x: int, y: int) -> Illuminance | None:
        """Lux on the surface at a pixel of the full size; None for the sky."""

    def surface_at_pixel(self, x: int, y: int) -> Hit | None:
        """The surface that a pixel of the full size shows; None for the sky."""

    def close(self) -> None:
        """Free all resources."""


class GlStage:
    """A `host` that draws with OpenGL, on its owner's thread; `gl` is the stage's from now on."""

    def __init__(self, gl: GlOwner | None = None) -> None:
        self.host = Host(runner=WindowJobs(), gl=gl)
        self._measures_next = False
        self.pass_seconds: dict[str, float] = {}
        self.failures: list[str] = self.host.failures

    @property
    def kernel(self) -> Kernel:
        """The host's kernel."""
        return self.host.kernel

    @property
    def renderer(self) -> str:
        """The renderer's name; another after a reset, perhaps."""
        return self.host.gl.opened.renderer

    @property
    def device(self) -> Device | None:
        """The renderer, tried out."""
        return self.host.gl.opened.device

    def measure_next(self) -> None:
        """Measure the next frame, whose passes wait for each other then."""
        self._measures_next = True

    @property
    def state(self) -> SceneState:
        """The state of the last whole revision."""
        return self.host.state

    @property
    def revision(self) -> int:
        """The number of that revision."""
        return self.host.revision

    @property
    def frame_counters(self) -> WorkCounters:
        """Counts of work that frames did and skipped."""
        return self.host.frame_counters

    def draw(self, state: SceneState, still: bool, is_given_up: IsGivenUp | None = None) -> Picture:
        """Draw a state; GivenUp is raised when `is_given_up()`."""
        if not self._measures_next:
            return self.host.draw_state(state, still, is_given_up)
        self._measures_next, self.pass_seconds = False, {}
        self.host.measure_passes(self._measured)
        try:
            return self.host.draw_state(state, still, is_given_up)
        finally:
            self.host.measure_passes(unmeasured)

    def light_at_pixel(self, x: int, y: int) -> Illuminance | None:
        """Lux on the surface at a pixel of the full size; None for the sky."""
        return self.host.light_at_pixel(x, y)

    def surface_at_pixel(self, x: int, y: int) -> Hit | None:
        """The surface that a pixel of the full size shows; None for the sky."""
        return self.host.surface_at_pixel(x, y)

    def close(self) -> None:
        """Cancel background jobs and free the GPU."""
        self.host.close()

    @contextmanager
    def _measured(self, name: str) -> Iterator[Any]:
        """Time one pass, on the GL thread, with all its deferred GL work."""
        from OpenGL.GL import glFinish

        start_s = perf_counter()
        yield
        glFinish()
        self.pass_seconds[name] = self.pass_seconds.get(name, 0.0) + perf_counter() - start_s

"""What the engine draws on: a host, and a note of what changed in it since the last picture."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.air import AirChanged
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.clouds import CloudsChanged
from vrut_lite.daylight.picture import SetExposure
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.host import Host
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.ledger import Ledger
from vrut_lite.render.light_meter import Illuminance
from vrut_lite.render.patience import IsGivenUp
from vrut_lite.render.rays import Hit
from vrut_lite.scene.backend import Picture, SceneBackend
from vrut_lite.scene.ground_disc import GroundDisc
from vrut_lite.scene.loading import LoadedScene

_NEEDED = {"scene", "background", "sun", "ambient", "camera"}


class WatchedBackend:
    """A `SceneBackend` that passes all on, and notes that there is something new to be seen."""

    def __init__(self, backend: SceneBackend):
        self._backend = backend
        self._told: set[str] = set()
        self.changed = False
        self.camera: MoveCamera | None = None
        self.size = (960, 540)

    @property
    def can_draw(self) -> bool:
        """Whether scene, light and camera are there."""
        return self._told >= _NEEDED

    def _note(self, what: str) -> None:
        self._told.add(what)
        self.changed = True

    def show_scene(self, scene: LoadedScene, ground: GroundDisc | None) -> None:
        """Show this scene, on this ground if there is one."""
        self._backend.show_scene(scene, ground)
        self._note("scene")

    def set_background(self, background: BackgroundChanged) -> None:
        """Show this sky."""
        self._backend.set_background(background)
        self._note("background")

    def set_sun_light(self, light: KeyLightChanged) -> None:
        """Light with this sun."""
        self._backend.set_sun_light(light)
        self._note("sun")

    def set_ambient(self, ambient: AmbientChanged) -> None:
        """Light with this sky."""
        self._backend.set_ambient(ambient)
        self._note("ambient")

    def set_air(self, air: AirChanged) -> None:
        """Show the scene through this air."""
        self._backend.set_air(air)
        self._note("air")

    def set_clouds(self, clouds: CloudsChanged) -> None:
        """Show these clouds."""
        self._backend.set_clouds(clouds)
        self._note("clouds")

    def set_light_shafts(self, light_shafts: bool) -> None:
        """Whether the scene shades the air."""
        self._backend.set_light_shafts(light_shafts)
        self._note("light shafts")

    def set_ground_albedo(self, albedo_rgb: NDArray[np.float64]) -> None:
        """Paint the ground disc."""
        self._backend.set_ground_albedo(albedo_rgb)
        self._note("ground")

    def set_camera(self, camera: MoveCamera) -> None:
        """Look from here."""
        self._backend.set_camera(camera)
        self.camera = camera
        self._note("camera")

    def set_sheltered(self, sheltered: bool) -> None:
        """Whether the camera is in a closed room."""
        self._backend.set_sheltered(sheltered)
        self._note("shelter")

    def set_exposure(self, exposure: SetExposure) -> None:
        """Expose like this."""
        self._backend.set_exposure(exposure)
        self._note("exposure")

    def set_size(self, width_px: int, height_px: int) -> None:
        """Draw pictures of this size."""
        self._backend.set_size(width_px, height_px)
        self.size = (width_px, height_px)
        self._note("size")

    def draw_sized(self, size: tuple[int, int], draw: Callable[[], Picture]) -> Picture:
        """Draw in another size, of which the kernel is not to know."""
        self._backend.set_size(*size)
        try:
            return draw()
        finally:
            self._backend.set_size(*self.size)

    def draw(self, still: bool = True) -> Picture:
        """Draw a frame."""
        return self._backend.draw(still)


class Stage(Protocol):
    """What the engine needs; all of it on the engine's thread."""

    @property
    def kernel(self) -> Kernel:
        """The kernel to pump."""

    @property
    def watched(self) -> WatchedBackend:
        """What the scene manager tells, noted."""

    @property
    def renderer(self) -> str:
        """What draws."""

    @property
    def failures(self) -> list[str]:
        """A sentence for each module that failed to load."""

    @property
    def pass_seconds(self) -> dict[str, float]:
        """What each pass of the last frame took."""

    @property
    def frame_ledger(self) -> Ledger:
        """What frames did and what they left out."""

    def draw(
        self, size: tuple[int, int], still: bool, is_given_up: IsGivenUp | None = None
    ) -> Picture:
        """Draw what is known by now; where that takes long, GivenUp is raised when it is."""

    def light_at_pixel(self, x: int, y: int) -> Illuminance | None:
        """Lux on what a pixel of the full size shows; None for the sky."""

    def surface_at_pixel(self, x: int, y: int) -> Hit | None:
        """The surface that a pixel of the full size shows; None for the sky."""

    def close(self) -> None:
        """Give everything back."""


class GlStage:
    """A host that draws with OpenGL, on its owner's thread."""

    def __init__(self) -> None:
        self._watched: list[WatchedBackend] = []
        self._host = Host(watch=self._watch)
        self._host.measure_passes(self._measured)
        self.pass_seconds: dict[str, float] = {}
        self.renderer: str = self._host.gl.renderer
        self.failures: list[str] = self._host.failures

    def _watch(self, backend: SceneBackend) -> SceneBackend:
        self._watched.append(WatchedBackend(backend))
        return self._watched[0]

    @property
    def kernel(self) -> Kernel:
        """The host's kernel."""
        return self._host.kernel

    @property
    def watched(self) -> WatchedBackend:
        """What the scene manager tells."""
        return self._watched[0]

    @property
    def frame_ledger(self) -> Ledger:
        """What frames did and what they left out."""
        return self._host.frame_ledger

    def draw(
        self, size: tuple[int, int], still: bool, is_given_up: IsGivenUp | None = None
    ) -> Picture:
        """Draw what is known by now, or raise GivenUp as soon as `is_given_up()`."""
        self.pass_seconds = {}
        return self.watched.draw_sized(size, lambda: self._host.draw_now(still, is_given_up))

    def light_at_pixel(self, x: int, y: int) -> Illuminance | None:
        """Lux on what a pixel of the full size shows; None for the sky."""
        return self._host.light_at_pixel(x, y)

    def surface_at_pixel(self, x: int, y: int) -> Hit | None:
        """The surface that a pixel of the full size shows; None for the sky."""
        return self._host.surface_at_pixel(x, y)

    def close(self) -> None:
        """Cancel background jobs and free the GPU."""
        self._host.close()

    @contextmanager
    def _measured(self, name: str) -> Iterator[Any]:
        """Time one pass, on the GL thread; work that GL put off belongs to the pass it is of.

        Waiting by `glFinish` lets Qt's thread run, where a read of pixels would wait inside GL.
        """
        from OpenGL.GL import glFinish

        start_s = perf_counter()
        yield
        glFinish()
        self.pass_seconds[name] = self.pass_seconds.get(name, 0.0) + perf_counter() - start_s

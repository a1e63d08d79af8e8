"""The interface of renderers: OpenGL, a path tracer, or none."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Protocol

from vrut_lite.kernel.bus import Kernel
from vrut_lite.pictures.picture import Picture
from vrut_lite.scene.scene_state import SceneState

IsGivenUp = Callable[[], bool]


class SceneBackend(Protocol):
    """Draws the scene; calls come from one thread at a time."""

    def prepare(self, state: SceneState) -> None:
        """Upload the parts that changed since the last call, before a picture is wanted.

        `draw` does so too; call this to get an error at once.

        Raises:
            UserError: the background's own shader does not compile; its cube map is drawn.
        """

    def draw(
        self, state: SceneState, still: bool = True, is_given_up: IsGivenUp | None = None
    ) -> Picture:
        """Draw a frame.

        A still is complete; in other frames slow work (reflections) may lag behind.

        Raises:
            RuntimeError: scene, light or camera is still missing.
            GivenUp: `is_given_up()` returned true; it is called repeatedly.
        """


class SceneView:
    """The scene's state and the backend that draws it, where there is one.

    The scene manager changes `pending`, part by part. `state` is what the host draws, also while
    the manager is restarted: `pending` when the kernel's revision is whole, and until the next one
    is, so that all parts of a picture are of one revision. Camera and size are always the present
    ones. Without a kernel nothing is awaited.
    """

    def __init__(self, kernel: Kernel | None = None, backend: SceneBackend | None = None):
        self._kernel = kernel
        self._backend = backend
        self.pending = self._published = self._state = SceneState()
        self._revision = 0

    @property
    def state(self) -> SceneState:
        """The parts of the last whole revision, seen by the present camera."""
        if self._kernel is None or self._kernel.is_whole:
            self._revision = 0 if self._kernel is None else self._kernel.revision
            if self.pending is not self._published:
                self._published = self._state = self.pending
        return self._state

    @property
    def revision(self) -> int:
        """The number of the last revision that was whole when `state` was asked for."""
        return self._revision

    def look(self, **parts: Any) -> None:
        """Replace camera, size, exposure or section in both states.

        The shown one keeps its own until it shows the pending one's scene.
        """
        self.pending = replace(self.pending, **parts)
        if self._published.scene is self.pending.scene:
            self._state = replace(self._state, **parts)

    def prepare(self) -> None:
        """Let the backend upload the changes; UserError as in `SceneBackend.prepare`."""
        if self._backend is not None:
            self._backend.prepare(self.pending)

"""The interface of renderers: OpenGL, a path tracer, or none."""

from collections.abc import Callable
from typing import Protocol

from vrut_lite.daylight.scene_state import SceneState
from vrut_lite.pictures.picture import Picture

IsGivenUp = Callable[[], bool]


class GivenUp(Exception):
    """The caller gave up the picture while it was being drawn."""


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

    The scene manager replaces the state; the host draws it, also while the manager is restarted.
    """

    def __init__(self, backend: SceneBackend | None = None):
        self.state = SceneState()
        self._backend = backend

    def prepare(self) -> None:
        """Let the backend upload the changes; UserError as in `SceneBackend.prepare`."""
        if self._backend is not None:
            self._backend.prepare(self.state)

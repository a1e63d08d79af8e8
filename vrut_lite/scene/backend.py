"""What draws the scene: OpenGL, a path tracer, or nothing at all."""

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
        """Bring to the GPU what has changed since the last call, before a picture is wanted.

        `draw` does so too; whoever must hear of an error at once calls this.

        Raises:
            UserError: the background's own shader does not compile; its cube map is drawn.
        """

    def draw(
        self, state: SceneState, still: bool = True, is_given_up: IsGivenUp | None = None
    ) -> Picture:
        """Draw a frame.

        A still is finished; in a frame of many, what changes slowly may lag behind.

        Raises:
            RuntimeError: scene, light or camera is still missing.
            GivenUp: `is_given_up()`, asked again and again, said so.
        """


class SceneView:
    """The scene's state and the backend that draws it, where there is one.

    The scene manager replaces the state; the host draws it, also while the manager is restarted.
    """

    def __init__(self, backend: SceneBackend | None = None):
        self.state = SceneState()
        self._backend = backend

    def prepare(self) -> None:
        """Let the backend take what has changed; UserError as `SceneBackend.prepare` says."""
        if self._backend is not None:
            self._backend.prepare(self.state)

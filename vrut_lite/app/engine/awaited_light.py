"""A picture at rest is finished with the light that is under way, not before it."""

from vrut_lite.app.engine.window_jobs import WindowJobs
from vrut_lite.daylight.light_map import SLOT
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.daylight.scene_state import SceneState
from vrut_lite.kernel.bus import Kernel

# Longer than the first light of any of the project's scenes takes; large texels come sooner.
_FIRST_PATIENCE_S = 5.0
# Longer than light takes on surfaces, or an atmosphere that is solved well after a draft.
_PATIENCE_S = 0.5
# Between two questions whether it is there.
LOOK_AGAIN_S = 0.05


class AwaitedLight:
    """Tells whether the first light of a scene, or what the last input caused, is under way.

    A finished picture is drawn for seconds by a software renderer, while the host hears nothing:
    the light's jobs would wait for it one after the other, and it would be drawn anew.
    """

    def __init__(self) -> None:
        self._scene: SceneOpened | None = None
        self._until_s = 0.0
        self._started_before = 0

    def note_input(self, kernel: Kernel) -> None:
        """From now on jobs count that an input starts, which is about to be acted on."""
        if isinstance(kernel.runner, WindowJobs):
            self._started_before = kernel.runner.started

    def is_awaited(self, kernel: Kernel, state: SceneState, now_s: float, due_s: float) -> bool:
        """Whether a finished picture is to wait that was due at some time.

        Each scene gets its patience when first asked.
        """
        if state.scene is not self._scene:
            self._scene, self._until_s = state.scene, now_s + _FIRST_PATIENCE_S
        if state.surface_light is None and now_s < self._until_s:
            return kernel.jobs.runs(kernel.slots.holder(SLOT))
        jobs = kernel.runner
        if now_s >= due_s + _PATIENCE_S or not isinstance(jobs, WindowJobs):
            return False
        return jobs.is_busy_since(self._started_before)

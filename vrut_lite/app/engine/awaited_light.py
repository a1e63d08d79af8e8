"""A picture at rest is finished with the light of surfaces that is under way, not before it."""

from vrut_lite.daylight.light_map import SLOT
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.daylight.scene_state import SceneState
from vrut_lite.kernel.bus import Kernel

# Longer than the first light of any of the project's scenes takes; large texels come sooner.
_FIRST_PATIENCE_S = 5.0
# After the hand's last move: an hour takes 0.05 s. Rays of further rounds, which take seconds, are
# not waited for.
_HOUR_PATIENCE_S = 0.35
# Between two questions whether it is there.
LOOK_AGAIN_S = 0.05


class AwaitedLight:
    """Tells whether the first light of a scene, or that of another hour, is under way.

    A finished picture is drawn for seconds by a software renderer, while the host hears nothing:
    the light's jobs would wait for it one after the other, and it would be drawn anew.
    """

    def __init__(self) -> None:
        self._scene: SceneOpened | None = None
        self._until_s = 0.0

    def is_awaited(
        self, kernel: Kernel, state: SceneState, now_s: float, moved_at_s: float
    ) -> bool:
        """Whether a finished picture is to wait.

        Each scene gets its patience when first asked, each hour when the hand moved last.
        """
        if state.scene is not self._scene:
            self._scene, self._until_s = state.scene, now_s + _FIRST_PATIENCE_S
        is_first = state.surface_light is None
        if now_s >= (self._until_s if is_first else moved_at_s + _HOUR_PATIENCE_S):
            return False
        return kernel.jobs.runs(kernel.slots.holder(SLOT))

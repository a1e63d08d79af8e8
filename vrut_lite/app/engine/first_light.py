"""A scene's first picture at rest is finished with the light between surfaces, not before it."""

from vrut_lite.daylight.light_map import SLOT
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.daylight.scene_state import SceneState
from vrut_lite.kernel.bus import Kernel

# Longer than the first light of any of the project's scenes takes; large texels come sooner.
_PATIENCE_S = 5.0
# Between two questions whether it is there.
LOOK_AGAIN_S = 0.05


class FirstLight:
    """Tells whether the first light of a scene is under way.

    A finished picture is drawn for seconds by a software renderer, while the host hears nothing:
    the light's jobs would wait for it one after the other, and it would be drawn anew.
    """

    def __init__(self) -> None:
        self._scene: SceneOpened | None = None
        self._until_s = 0.0

    def is_awaited(self, kernel: Kernel, state: SceneState, now_s: float) -> bool:
        """Whether a finished picture is to wait; each scene gets its patience when first asked."""
        if state.scene is not self._scene:
            self._scene, self._until_s = state.scene, now_s + _PATIENCE_S
        if state.surface_light is not None or now_s >= self._until_s:
            return False
        return kernel.jobs.runs(kernel.slots.holder(SLOT))

"""When the window's finished picture has light by rays of its own: once it stands."""

from dataclasses import fields

from vrut_lite.daylight.scene_state import SceneState
from vrut_lite.daylight.view_light import ViewLightChanged
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand

_OTHERS = [field.name for field in fields(SceneState) if field.name != "view_light"]


class FinerLight:
    """Asks for the light of the points that a finished picture shows; ends with the next change.

    The rays take seconds: a picture is finished without them first.
    """

    def __init__(self) -> None:
        self._wanted = False

    def drew(self, kernel: Kernel, still: bool) -> None:
        """A picture was drawn, finished or not."""
        if still != self._wanted:
            self._wanted = still
            kernel.inject(
                Demand(
                    consumer="finished picture",
                    message=ViewLightChanged.__name__,
                    size=None if still else 0,
                )
            )


def is_only_finer(before: SceneState | None, now: SceneState) -> bool:
    """Whether a picture may go on being finished: nothing but the light of its points is new."""
    return (
        before is not None
        and now.view_light is not None
        and now.view_light is not before.view_light
        and all(getattr(before, name) is getattr(now, name) for name in _OTHERS)
    )

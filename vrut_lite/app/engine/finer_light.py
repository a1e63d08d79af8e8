"""Demand for light by rays of the window's own picture, once that is finished."""

from vrut_lite.installed_parts import changed_kinds
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, Derived
from vrut_lite.messages.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.view_light import ViewLightChanged
from vrut_lite.scene.scene_state import SceneState

# Longer than it takes to solve an atmosphere on a quiet machine.
_PAUSE_S = 1.0


class FinerLight:
    """Asks for the light of the points that a finished picture shows; ends with the next change.

    The rays take seconds: a picture is finished without them first. They give way to what an input
    causes: an atmosphere that is being solved shows nothing yet, and would take twice as long.
    """

    def __init__(self) -> None:
        self._wanted = False
        self.resumes_at_s: float | None = None

    def drew(self, kernel: Kernel, still: bool) -> None:
        """A picture was drawn, finished or not."""
        self.resumes_at_s = None
        self._want(kernel, still)

    def give_way(self, kernel: Kernel, state: SceneState, now_s: float) -> None:
        """Pause, as an input came; light that has arrived stays."""
        if self.resumes_at_s is not None or (self._wanted and not state.has_finished_light):
            self._want(kernel, False)
            self.resumes_at_s = now_s + _PAUSE_S

    def resume(self, kernel: Kernel, now_s: float) -> None:
        """Go on after a pause in which nothing was drawn."""
        if self.resumes_at_s is not None and now_s >= self.resumes_at_s:
            self.resumes_at_s = None
            self._want(kernel, True)

    def _want(self, kernel: Kernel, wanted: bool) -> None:
        if wanted != self._wanted:
            self._wanted = wanted
            kernel.inject(
                Demand(
                    consumer="finished picture",
                    message=ViewLightChanged.__name__,
                    size=None if wanted else 0,
                )
            )


def is_only_finer(before: SceneState | None, now: SceneState) -> bool:
    """Whether a picture may go on being finished: nothing but the light of its points is new."""
    finer = now.shown(ViewLightChanged) is not None
    return before is not None and finer and _changed(before, now) == {ViewLightChanged}


def is_only_lit(before: SceneState | None, now: SceneState) -> bool:
    """Whether nothing but the light of surfaces is new, which they had before too."""
    if before is None or None in (state.shown(SurfaceLightChanged) for state in (before, now)):
        return False
    changed = _changed(before, now)
    of_light = all(kind.slot == SurfaceLightChanged.slot for kind in changed)
    return of_light and SurfaceLightChanged in changed and LightMapLaid not in changed


def _changed(before: SceneState, now: SceneState) -> set[type[Derived]]:
    """Types of changed messages of frame parts; empty if other parts of the state changed too."""
    if not now.shares_all_but(before, "parts"):
        return set()
    return changed_kinds(before.parts, now.parts)

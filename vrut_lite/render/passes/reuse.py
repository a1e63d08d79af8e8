"""Pictures while something moves take over from the picture before what still holds there.

Radiance does not depend on the camera but for what coats mirror. Of each picture a sixteenth is
drawn anew in turns, an eighth where the light changes, more of what mirrors, and what was not seen
before; all else moves to where the camera sees it now.
"""

from typing import Any, NamedTuple

import numpy as np
from OpenGL import GL

from vrut_lite.daylight.scene_state import SceneState
from vrut_lite.numeric_types import FloatArray
from vrut_lite.render.change_of_light import change_of_light
from vrut_lite.render.moving_targets import Drawn, MovingTargets
from vrut_lite.render.passes.full_screen import FullScreen
from vrut_lite.render.passes.view import View, translation

# Pictures from one turn of a pixel to the next: under the same light, and under another.
_TURNS, _TURNS_OF_LIGHT, _STEP = 16, 8, 3


class _Before(NamedTuple):
    drawn: Drawn
    view: View
    state: SceneState
    reflection: Any


class Reuse:
    """Made and used on the GL thread only."""

    def __init__(self, context: Any):
        self._context = context
        self._screen: FullScreen | None = None
        self._before: _Before | None = None
        self._turn = 0

    def begin(self, targets: MovingTargets, view: View, state: SceneState, reflection: Any) -> None:
        """Fill a target with what is taken over; `front` is drawn already.

        Depth is then such that surfaces and sky are drawn elsewhere alone. Of what is not solid
        nothing is taken over, and nothing at all when another `reflection` has been finished.
        """
        if self._screen is None:
            self._screen = FullScreen(self._context, "reuse.frag")
        before, drawn = self._before, targets.begin()
        brighter = None
        if before is not None and before.reflection is reflection:
            brighter = change_of_light(before.state, state)
        if before is None or brighter is None:
            before, brighter = _Before(drawn, view, state, reflection), np.ones(3)
            self._screen.set("turn", -1)
        else:
            self._turn = (self._turn + _STEP) % _TURNS
            self._screen.set("turn", self._turn)
            turns = _TURNS if np.all(brighter == 1.0) else _TURNS_OF_LIGHT
            self._screen.set("most_apart", turns - 1)
        self._screen.set("brighter", brighter)
        self._screen.set("old_from_clip", _old_from_clip(before.view, view).T.ravel())
        moved_m = float(np.linalg.norm(view.eye_m - before.view.eye_m))
        self._screen.set("seen_turned", moved_m / float(view.projection[2, 3]))
        targets.front.use(0)
        before.drawn.radiance.use(location=1)
        before.drawn.depth.use(2)
        for unit, name in enumerate(("front", "old_radiance", "old_depth")):
            self._screen.program[name].value = unit
        drawn.buffer.use()
        self._context.enable(self._context.DEPTH_TEST)
        self._context.disable(self._context.CULL_FACE | self._context.BLEND)
        GL.glDepthMask(GL.GL_TRUE)
        GL.glDepthFunc(GL.GL_ALWAYS)
        self._screen.draw()
        GL.glDepthFunc(GL.GL_GREATER)
        self._before = _Before(drawn, view, state, reflection)

    def release(self) -> None:
        """Free the GL objects."""
        self._before = None
        if self._screen is not None:
            self._screen.release()


def _old_from_clip(old: View, now: View) -> FloatArray:
    """Matrix (4, 4) from the clip coordinates of one view to those of another."""
    eye_from_clip = np.linalg.inv(now.clip_from_eye)
    return np.asarray(old.clip_from_eye @ translation(now.eye_m - old.eye_m) @ eye_from_clip)

"""Smooths the steps that one sample a pixel leaves at edges, after the tone map."""

from typing import Any

from vrut_lite.render.moving_targets import MovingTargets
from vrut_lite.render.passes.full_screen import FullScreen


class EdgeFilter:
    """Made and used on the GL thread only."""

    def __init__(self, context: Any):
        self._context = context
        self._screen: FullScreen | None = None

    def draw(self, targets: MovingTargets) -> None:
        """Turn what was tone-mapped into the picture for display."""
        if self._screen is None:
            self._screen = FullScreen(self._context, "edge_filter.frag")
        targets.display.use()
        targets.use_toned()
        self._context.disable(
            self._context.DEPTH_TEST | self._context.CULL_FACE | self._context.BLEND
        )
        self._screen.draw()

    def release(self) -> None:
        """Free the GL objects."""
        if self._screen is not None:
            self._screen.release()

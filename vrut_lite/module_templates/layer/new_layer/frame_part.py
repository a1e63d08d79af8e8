"""The rainbow in the picture: over the sky, behind clouds and surfaces."""

from pathlib import Path
from typing import Any

from vrut_lite.frame_part import FramePart, Heard, PartView, Screen

from new_layer.bow import STEP_DEG, RainbowShown, phase_rgb

_SHADER = Path(__file__).parent / "shaders" / "rainbow.frag"


class NewLayerPart(FramePart):
    """Draws what `RainbowShown` says, on the GL thread."""

    hears = (RainbowShown,)
    _shown: Any = None
    _screen: Screen | None = None

    def show(self, heard: Heard) -> None:
        """Another rainbow, or none."""
        self._shown = heard.get(RainbowShown)

    @property
    def is_seen(self) -> bool:
        """Whether it shines."""
        return bool(self._shown and max(self._shown.light_rgb) > 0.0)

    def draw_over_sky(self, size_px: tuple[int, int], view: PartView) -> None:
        """Add it to the sky."""
        shown, screen = self._shown, self._screen or self.gl.screen(_SHADER)
        if self._screen is None:
            self._screen = screen
            screen.program["phase_rgb"].value = phase_rgb().tolist()
            screen.set("step_deg", STEP_DEG)
        screen.set("antisolar", shown.antisolar)
        screen.set("light_rgb", shown.light_rgb)
        screen.draw(view)
        self.gl.counters.did("new_layer")

"""The curtains in the frame: over the stars, behind the clouds."""

from pathlib import Path
from typing import Any

import numpy as np

from aurora.curtains import MOLECULES, SCALE_KM, AuroraShown, line_colours
from vrut_lite.frame_part import FramePart, Heard, PartView, Screen

_SHADER = Path(__file__).parent / "shaders" / "aurora.frag"


class AuroraPart(FramePart):
    """Draws what `AuroraShown` says."""

    hears = (AuroraShown,)
    _shown: Any = None
    _screen: Screen | None = None

    def show(self, heard: Heard) -> None:
        """Other curtains, or none."""
        self._shown = heard.get(AuroraShown)

    @property
    def is_seen(self) -> bool:
        """Whether they shine."""
        return bool(self._shown and self._shown.kilorayleigh > 0.0)

    def draw_over_sky(self, size_px: tuple[int, int], view: PartView) -> None:
        """Add them to the sky."""
        shown, screen = self._shown, self._screen or self.gl.screen(_SHADER)
        self._screen, eye_km = screen, max(float(view.eye_m[1]), 0.0) / 1000.0
        for name in ("edge_km", "width_km", "lean", "poleward"):
            screen.set(name, getattr(shown, name))
        screen.set("east", np.cross(shown.poleward, [0.0, 1.0, 0.0]))
        screen.set("eye_km", eye_km)
        screen.set("air_depth", (np.array(MOLECULES) + shown.haze) * np.exp(-eye_km / SCALE_KM))
        screen.program["phases"].value = list(shown.phases)
        screen.program["line_rgb"].value = (shown.kilorayleigh * line_colours()).tolist()
        screen.draw(view)
        self.gl.counters.did("aurora")

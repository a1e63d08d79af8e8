"""The last pass: exposure, white balance, tone map and dither into 8 bits."""

from typing import Any

from vrut_lite.daylight.picture import SetExposure
from vrut_lite.geometry.colour import LUMINANCE_WEIGHTS
from vrut_lite.pictures import exposure, tone_map
from vrut_lite.pictures.white_balance import white_balance_matrix
from vrut_lite.render.passes.full_screen import FullScreen
from vrut_lite.render.targets import Targets

# As tone_map.frag numbers them.
_CURVES = {"none": 0, "exponential": 1, "agx": 2}


class TonePass:
    """Made and used on the GL thread only."""

    def __init__(self, context: Any):
        self._context = context
        self._screen = FullScreen(context, "tone_map.frag")
        self._screen.set("inset", tone_map.INSET.T.ravel())
        self._screen.set("outset", tone_map.OUTSET.T.ravel())
        self._screen.set("darkest_log2", tone_map.DARKEST_LOG2)
        self._screen.set("brightest_log2", tone_map.BRIGHTEST_LOG2)
        self._screen.set("contrast", tone_map.CONTRAST)
        self._screen.set("saturation", tone_map.SATURATION)
        self._screen.set("exponential_rate", float(tone_map.EXPONENTIAL_RATE))
        self._screen.set("luminance_weights", LUMINANCE_WEIGHTS)
        self._screen.program["sigmoid"].value = list(tone_map.SIGMOID)

    def draw(self, targets: Targets, ev100: float, wish: SetExposure) -> None:
        """Turn the resolved radiance into the picture for display."""
        targets.display.use()
        targets.radiance.use(location=0)
        matrix = white_balance_matrix(wish.white_temperature_k, wish.white_duv)
        self._screen.set("white_balance", matrix.T.ravel())
        self._screen.set("exposure_scale", exposure.scale_of(ev100))
        self._screen.set("curve", _CURVES[wish.tone_map])
        self._context.disable(
            self._context.DEPTH_TEST | self._context.CULL_FACE | self._context.BLEND
        )
        self._screen.draw()

    def release(self) -> None:
        """Free the GL objects."""
        self._screen.release()

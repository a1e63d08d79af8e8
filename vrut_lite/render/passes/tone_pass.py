"""The last pass: exposure, white balance, tone map and dither into 8 bits."""

from functools import lru_cache
from typing import Any

import numpy as np

from vrut_lite.geometry.colour import LUMENS_PER_WATT, LUMINANCE_WEIGHTS
from vrut_lite.messages.picture import SetExposure, ToneMap
from vrut_lite.numeric_types import FloatArray
from vrut_lite.pictures import exposure, night_eye, tone_map
from vrut_lite.pictures.white_balance import white_balance_matrix
from vrut_lite.render.passes.full_screen import FullScreen
from vrut_lite.render.shader_files import Defines

# As in tone_map.frag.
_DEGREE = 7
_CURVES: dict[str, Defines] = {
    "none": (),
    "exponential": ("EXPONENTIAL",),
    "agx": ("AGX",),
}


@lru_cache(maxsize=1)
def _curve_in_one() -> list[float]:
    """Coefficients of AgX's sigmoid with its contrast: a power takes three times as long.

    Within 0.1 of 255 of the two.
    """
    x = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 400))
    both = np.maximum(np.polynomial.polynomial.polyval(x, tone_map.SIGMOID), 0.0)
    fit = np.polynomial.Polynomial.fit(x, both**tone_map.CONTRAST, _DEGREE)
    return [float(number) for number in fit.convert().coef]


def from_radiance(ev100: float, wish: SetExposure) -> FloatArray:
    """Matrix (3, 3) from radiance to the arguments of the channels' curves."""
    matrix = white_balance_matrix(wish.white_temperature_k, wish.white_duv)
    if "AGX" in _CURVES[wish.tone_map]:
        matrix = tone_map.INSET @ matrix
    return np.asarray(exposure.scale_of(ev100) * matrix)


def outset(curve: ToneMap) -> FloatArray:
    """Matrix (3, 3) from the curves' values to colours: AgX's saturation and outset."""
    if "AGX" not in _CURVES[curve]:
        return np.eye(3)
    grey = np.outer(np.ones(3), (1.0 - tone_map.SATURATION) * np.asarray(LUMINANCE_WEIGHTS))
    return np.asarray(tone_map.OUTSET @ (grey + tone_map.SATURATION * np.eye(3)))


class TonePass:
    """Made and used on the GL thread only; compiles a curve on first use."""

    def __init__(self, context: Any):
        self._context = context
        self._screens: dict[tuple[ToneMap, bool], FullScreen] = {}

    def draw(
        self, radiance: Any, display: Any, ev100: float, wish: SetExposure, pixel_rad: float
    ) -> None:
        """Turn a texture of radiance into a framebuffer for display, with luma as its alpha."""
        field_cd = night_eye.adapted_cd(ev100, wish.night_look)
        key = wish.tone_map, field_cd is not None
        if key not in self._screens:
            self._screens[key] = self._screen(*key)
        screen = self._screens[key]
        display.use()
        radiance.use(location=0)
        screen.set("from_radiance", from_radiance(ev100, wish).T.ravel())
        blur, reach = night_eye.blur_px(pixel_rad)
        screen.set("blur", blur)
        if field_cd is not None:
            screen.set("field", field_cd / LUMENS_PER_WATT)
        if "reach" in screen.program:
            screen.program["reach"].value = reach
        self._context.disable(
            self._context.DEPTH_TEST | self._context.CULL_FACE | self._context.BLEND
        )
        screen.draw()

    def _screen(self, curve: ToneMap, by_eye: bool) -> FullScreen:
        defines = (*_CURVES[curve], "EYE") if by_eye else _CURVES[curve]
        screen = FullScreen(self._context, "tone_map.frag", defines)
        screen.set("outset", outset(curve).T.ravel())
        screen.set("darkest", 2.0**tone_map.DARKEST_LOG2)
        screen.set("darkest_log2", tone_map.DARKEST_LOG2)
        screen.set("per_log2", 1.0 / (tone_map.BRIGHTEST_LOG2 - tone_map.DARKEST_LOG2))
        screen.set("exponential_rate", float(tone_map.EXPONENTIAL_RATE))
        screen.set("luminance_weights", LUMINANCE_WEIGHTS)
        screen.set("xyz_from_srgb", night_eye.XYZ_FROM_SRGB.T.ravel())
        screen.set("rods_grey", night_eye.RODS_GREY_RGB)
        screen.set("rods_blue", night_eye.RODS_BLUE_RGB)
        screen.set("rods_alone", night_eye.RODS_ALONE_CD / LUMENS_PER_WATT)
        screen.set("acuity", night_eye.ACUITY)
        screen.set("least_cycles", night_eye.LEAST_CYCLES)
        screen.set("sharp_px", night_eye.SHARP_PX)
        screen.set("deviations", night_eye.DEVIATIONS)
        screen.set("lumens_per_watt", LUMENS_PER_WATT)
        screen.set("cones_alone", night_eye.CONES_ALONE_CD / LUMENS_PER_WATT)
        if "curve" in screen.program:
            screen.program["curve"].value = _curve_in_one()
        return screen

    def release(self) -> None:
        """Free the GL objects."""
        for screen in self._screens.values():
            screen.release()

"""Exposure value from what the camera sees.

A picture value of 1 is the luminance 1.2 * 2^EV100 cd m^-2 (the saturation-based speed of
ISO 12232, as Lagarde 2014 uses it); automatic exposure puts the mean on middle grey.
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.picture import SetExposure
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance

MIDDLE_GREY = 0.18
_SATURATION = 1.2
# Starlight: below it the picture darkens as the scene does.
_DARKEST_EV100 = -8.0
# Below this the eye no longer adapts in full, and a picture that did would make dusk look
# like noon: it keeps this fraction of each further stop as darkness (after Krawczyk 2005).
_FULL_ADAPTATION_EV100 = 9.0
_DARKNESS_KEPT = 0.3
_BRIGHTEST_SHARE = 0.002
_ENOUGH_PIXELS = 2**17
_BRIGHT_QUANTILE, _STOPS_BELOW_BRIGHT = 0.9, 4.0


def scale_of(ev100: float) -> float:
    """Factor from linear sRGB radiance (W m^-2 sr^-1) to picture values."""
    return LUMENS_PER_WATT / (_SATURATION * 2.0**ev100)


def ev100_of(wish: SetExposure, radiance_rgb: NDArray[np.floating]) -> float:
    """EV100 that is wished for a picture (..., 3) of linear sRGB radiance in W m^-2 sr^-1."""
    metered = wish.ev100 if wish.mode == "manual" else automatic_ev100(radiance_rgb)
    return metered - wish.compensation_ev


def automatic_ev100(radiance_rgb: NDArray[np.floating]) -> float:
    """EV100 for a picture (..., 3) of linear sRGB radiance in W m^-2 sr^-1.

    The log mean of luminance, without the brightest 0.2 % of the pixels (the sun's disc and
    its glints), which no exposure could hold, and with what is darker than four stops below
    the brighter parts counted as just that: black ground must not blow out what is lit. Of a
    large picture (h, w, 3) every second, third, ... pixel stands for its neighbours.
    """
    if radiance_rgb.ndim == 3:
        step = max(1, int(np.sqrt(radiance_rgb.shape[0] * radiance_rgb.shape[1] / _ENOUGH_PIXELS)))
        radiance_rgb = radiance_rgb[step // 2 :: step, step // 2 :: step]
    values = luminance(radiance_rgb).ravel()
    values = np.sort(values[np.isfinite(values)])
    darkest = MIDDLE_GREY / scale_of(_DARKEST_EV100)
    if values.size == 0:
        values = np.array([darkest])
    kept = values[: max(1, int(values.size * (1.0 - _BRIGHTEST_SHARE)))]
    floor = max(darkest, float(np.quantile(kept, _BRIGHT_QUANTILE)) * 2.0**-_STOPS_BELOW_BRIGHT)
    mean = float(np.exp(np.mean(np.log(np.maximum(kept, floor)))))
    metered = float(np.log2(mean * LUMENS_PER_WATT / (_SATURATION * MIDDLE_GREY)))
    return metered + _DARKNESS_KEPT * max(0.0, _FULL_ADAPTATION_EV100 - metered)

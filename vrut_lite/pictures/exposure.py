"""Exposure value of a picture.

A picture value of 1 is the luminance 1.2 * 2^EV100 cd m^-2 (the saturation-based speed of
ISO 12232, as Lagarde 2014 uses it); automatic exposure puts the mean on middle grey.
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.picture import SetExposure

MIDDLE_GREY = 0.18
_SATURATION = 1.2
# Lowest automatic EV100 (starlit ground): below it the picture darkens with the scene.
_DARKEST_EV100 = -11.0
# EV100 below which the eye no longer adapts in full; full adaptation would make dusk look like
# noon. Share of each further stop kept as darkness (after Krawczyk 2005), and its limit (stops),
# reached a little below the light of a full moon: starlight must not be lost in black.
_FULL_ADAPTATION_EV100 = 9.0
_DARKNESS_KEPT, _MOST_DARKNESS_EV = 0.3, 4.5
_BRIGHTEST_SHARE = 0.002
_ENOUGH_PIXELS = 2**17
_BRIGHT_QUANTILE, _STOPS_BELOW_BRIGHT = 0.9, 4.0
# Stops below the brighter parts at which pixels count as unlit: space, black ground behind air.
_UNLIT_STOPS = 10.5
# Quantiles of the picture's darker half without its darkest tenth: the walls of a room.
_WALLS = (0.1, 0.6)
# Stops above these between which the weight of a pixel falls to zero: the range of the sky in a
# window, and of few outdoor pixels. With both settings 75 of 80 pictures of our scenes keep their
# exposure within 0.05 EV (four times of day, two skies), and walls beside windows a hundred times
# as bright, on up to 30 % of the picture, are shown within half a stop of middle grey.
_OUTSHINES_FROM, _OUTSHINES_FULLY = 4.5, 6.5


def scale_of(ev100: float) -> float:
    """Factor from linear sRGB radiance (W m^-2 sr^-1) to picture values."""
    return LUMENS_PER_WATT / (_SATURATION * 2.0**ev100)


def ev100_of(wish: SetExposure, radiance_rgb: NDArray[np.floating]) -> float:
    """Unlimited EV100 for a picture (..., 3) of linear sRGB radiance in W m^-2 sr^-1."""
    metered = wish.ev100 if wish.mode == "manual" else automatic_ev100(radiance_rgb)
    return metered - wish.compensation_ev


def automatic_ev100(radiance_rgb: NDArray[np.floating], enough: int = _ENOUGH_PIXELS) -> float:
    """EV100 for a picture (..., 3) of linear sRGB radiance in W m^-2 sr^-1.

    The log mean of luminance, without the brightest 0.2 % of the pixels (the sun's disc and its
    glints) and without pixels that far outshine the picture's darker half, such as the sky in a
    room's window. Pixels darker than four stops below the brighter parts count as four stops,
    unless they are half of the picture: black ground must not overexpose lit surfaces. A picture
    (h, w, 3) of more than `enough` pixels is sampled at every second, third, ... pixel.
    """
    if radiance_rgb.ndim == 3:
        step = max(1, int(np.sqrt(radiance_rgb.shape[0] * radiance_rgb.shape[1] / enough)))
        radiance_rgb = radiance_rgb[step // 2 :: step, step // 2 :: step]
    values = luminance(radiance_rgb).ravel()
    values = np.sort(values[np.isfinite(values)])
    darkest = MIDDLE_GREY / scale_of(_DARKEST_EV100)
    if values.size == 0:
        values = np.array([darkest])
    kept = values[: max(1, int(values.size * (1.0 - _BRIGHTEST_SHARE)))]
    mean = 2.0 ** _mean_stops(np.log2(np.maximum(kept, darkest)))
    metered = float(np.log2(mean * LUMENS_PER_WATT / (_SATURATION * MIDDLE_GREY)))
    darkness = _DARKNESS_KEPT * max(0.0, _FULL_ADAPTATION_EV100 - metered)
    return metered + min(darkness, _MOST_DARKNESS_EV)


def _mean_stops(stops: NDArray[np.floating]) -> float:
    """The metered mean of log2 luminances (n,) that rise."""
    floor = float(np.quantile(stops, _BRIGHT_QUANTILE)) - _STOPS_BELOW_BRIGHT
    unlit = np.searchsorted(stops, floor + _STOPS_BELOW_BRIGHT - _UNLIT_STOPS)
    if unlit:
        stops[:unlit] = floor
        stops.sort()
    first, last = (int(share * stops.size) for share in _WALLS)
    walls = float(np.mean(stops[first : max(last, first + 1)]))
    above = np.maximum(stops, min(floor, walls)) - walls
    counts = np.interp(above, (_OUTSHINES_FROM, _OUTSHINES_FULLY), (1.0, 0.0))
    return walls + float(np.sum(counts * above) / np.sum(counts))

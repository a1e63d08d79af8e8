"""Exposure value of a picture.

A picture value of 1 is the luminance 1.2 * 2^EV100 cd m^-2 (the saturation-based speed of
ISO 12232, as Lagarde 2014 uses it).

Automatic exposure is a meter's reading, which puts the mean on middle grey, and by day outdoors a
photographer's correction of it. The correction compares the picture's highlights (99th percentile
of luminance) and a white matte card turned to the key light, as an incident-light meter reads it:

* Where highlights are at most two stops darker than the card, the picture shows things in full
  light. Exposure rises until the highlights are just below clipping, by one stop at most, while
  the card is less than two stops above an incident-light meter's exposure; and further where it is
  less than 0.7 stops above: snow is white.
* Where they are darker by 2.75 stops or more, the subject is dark: exposure falls to the
  incident-light meter's, by one stop at most. A black cat stays black.
* Rooms and deep shade, where the card would be far above white, keep the meter's exposure, and so
  does all that is darker than EV100 9; the correction is whole from EV100 12.
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.picture import NightLook, SetExposure

MIDDLE_GREY = 0.18
_SATURATION = 1.2
# Lowest automatic EV100 (starlit ground): below it the picture darkens with the scene.
_DARKEST_EV100 = -11.0
# EV100 below which the eye no longer adapts in full; full adaptation would make dusk look like
# noon. Share of each further stop kept as darkness (after Krawczyk 2005), and its limit (stops),
# reached a little below the light of a full moon: starlight must not be lost in black. A long
# exposure of moonlit land is usually one stop below the meter's (EV -3 to -2 at ISO 100).
_FULL_ADAPTATION_EV100 = 9.0
_DARKNESS_KEPT: dict[NightLook, tuple[float, float]] = {"eye": (0.3, 4.5), "exposure": (0.07, 1.0)}
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
# Metered EV100 between which the correction grows to its whole.
_CORRECTED_EV100 = (_FULL_ADAPTATION_EV100, 12.0)
# Share of pixels without the highlights' upper end: the sun, glints, lamps.
_HIGHLIGHT_QUANTILE = 0.99
# Stops above middle grey of highlights just below clipping (AgX: 228 of 255), and of a white card
# as an incident-light meter exposes it.
_HIGHLIGHT_STOPS, _INCIDENT_STOPS = 4.0, float(-np.log2(MIDDLE_GREY))
_MOST_CORRECTION_EV = 1.0
# Stops of the card above the incident-light meter's exposure: of bright subjects, and at most.
_BRIGHT_SUBJECT_EV, _OVEREXPOSED_EV = 0.7, 2.0
# Stops of the highlights below the card: in full light, and of a dark subject.
_IN_FULL_LIGHT, _DARK_SUBJECT = 2.0, 2.75
# Stops of the card above middle grey between which the picture counts as a room or deep shade.
_OPEN_STOPS, _ROOM_STOPS = 4.5, 6.0


def scale_of(ev100: float) -> float:
    """Factor from linear sRGB radiance (W m^-2 sr^-1) to picture values."""
    return LUMENS_PER_WATT / (_SATURATION * 2.0**ev100)


def ev100_of(wish: SetExposure, radiance_rgb: NDArray[np.floating], white: float = 0.0) -> float:
    """Unlimited EV100 for a picture, as `automatic_ev100` meters it."""
    if wish.mode == "manual":
        return wish.ev100 - wish.compensation_ev
    return automatic_ev100(radiance_rgb, white, wish.night_look) - wish.compensation_ev


def automatic_ev100(
    radiance_rgb: NDArray[np.floating],
    white: float = 0.0,
    night_look: NightLook = "eye",
    enough: int = _ENOUGH_PIXELS,
) -> float:
    """EV100 for a picture (..., 3) of linear sRGB radiance in W m^-2 sr^-1.

    `white` is the luminance (W m^-2 sr^-1) of a white card in the light of the hour; 0 if unknown:
    then there is no correction.

    The meter's reading is the log mean of luminance, without the brightest 0.2 % of the pixels (the
    sun's disc and its glints) and without pixels that far outshine the picture's darker half, such
    as the sky in a room's window. Pixels darker than four stops below the brighter parts count as
    four stops, unless they are half of the picture: black ground must not overexpose lit surfaces.
    A picture (h, w, 3) of more than `enough` pixels is sampled at every second, third, ... pixel.
    """
    if radiance_rgb.ndim == 3:
        step = max(1, int(np.sqrt(radiance_rgb.shape[0] * radiance_rgb.shape[1] / enough)))
        radiance_rgb = radiance_rgb[step // 2 :: step, step // 2 :: step]
    values = luminance(radiance_rgb).ravel()
    return metered_ev100(np.sort(values[np.isfinite(values)]), white, night_look)


def metered_ev100(
    values: NDArray[np.floating], white: float = 0.0, night_look: NightLook = "eye"
) -> float:
    """The same of finite luminances (n,) in W m^-2 sr^-1, ascending."""
    darkest = MIDDLE_GREY / scale_of(_DARKEST_EV100)
    if values.size == 0:
        values = np.array([darkest])
    kept = values[: max(1, int(values.size * (1.0 - _BRIGHTEST_SHARE)))]
    mean_stops = _mean_stops(np.log2(np.maximum(kept, darkest)))
    metered = mean_stops + float(np.log2(LUMENS_PER_WATT / (_SATURATION * MIDDLE_GREY)))
    if white > 0.0 and metered >= _FULL_ADAPTATION_EV100:
        highlight = max(float(np.quantile(values, _HIGHLIGHT_QUANTILE)), darkest)
        metered -= float(np.interp(metered, _CORRECTED_EV100, (0.0, 1.0))) * _correction_ev(
            float(np.log2(white)) - mean_stops, float(np.log2(highlight)) - mean_stops
        )
    return _darkened(metered, night_look)


def uncorrected_ev100(mean_cd: float, night_look: NightLook) -> float:
    """Automatic EV100 of a picture of this mean luminance (cd m^-2), uncorrected."""
    metered = float(np.log2(mean_cd / (_SATURATION * MIDDLE_GREY)))
    return _darkened(max(metered, _DARKEST_EV100), night_look)


def metered_cd(ev100: float, night_look: NightLook) -> float:
    """Mean luminance (cd m^-2) of a picture that is automatically exposed so, uncorrected.

    The inverse of `uncorrected_ev100`.
    """
    share, most_ev = _DARKNESS_KEPT[night_look]
    darker = max(0.0, _FULL_ADAPTATION_EV100 - ev100) / (1.0 - share)
    metered = ev100 - min(share * darker, most_ev)
    return float(MIDDLE_GREY * _SATURATION * 2.0**metered)


def _darkened(metered: float, night_look: NightLook) -> float:
    """EV100 at which a picture of a metered EV100 is shown: dusk is darker than noon."""
    kept_share, most_ev = _DARKNESS_KEPT[night_look]
    return metered + min(kept_share * max(0.0, _FULL_ADAPTATION_EV100 - metered), most_ev)


def _correction_ev(card: float, highlight: float) -> float:
    """Stops by which a picture is shown brighter than metered.

    `card` and `highlight` are the stops above middle grey of a white card and of the highlights, as
    metered.
    """
    headroom = max(_HIGHLIGHT_STOPS - highlight, 0.0)
    bright_subject = _INCIDENT_STOPS + _BRIGHT_SUBJECT_EV - card
    to_highlights = min(max(_INCIDENT_STOPS + _OVEREXPOSED_EV - card, 0.0), _MOST_CORRECTION_EV)
    raised = min(max(bright_subject, to_highlights), headroom)
    lowered = min(max(card - _INCIDENT_STOPS, 0.0), _MOST_CORRECTION_EV) * float(
        np.interp(card, (_OPEN_STOPS, _ROOM_STOPS), (1.0, 0.0))
    )
    full_light = np.interp(card - highlight, (_IN_FULL_LIGHT, _DARK_SUBJECT), (1.0, 0.0))
    return float(full_light * raised - (1.0 - full_light) * lowered)


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

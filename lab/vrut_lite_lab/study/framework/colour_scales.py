"""The scales that turn luminance and relative error into colours, in steps.

The layout is that of the published figures: for luminance nine steps per decade, from 1 to
10^6, each decade a hue of its own that pales as it rises; for errors 41 steps of 10 % between
-200 and 200 %, blue through white to red. The colours are Brewer's (colorbrewer2.org), sampled
from matplotlib: the published error scale is close to its one here, the published luminance
scale has other hues in the same layout.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

Colours = NDArray[np.uint8]

DECADES = 6
_STEPS = 9
_ERROR_STEPS = 41
_HUES = ("Greys_r", "Purples_r", "Blues_r", "Greens_r", "YlOrBr_r", "Reds_r")
# Brewer's palest is nearly white for every hue: leave it out, so that decades stay apart.
_PALEST = 0.8
_BELOW, _ABOVE = np.array([[255, 0, 0], [255, 255, 0]], dtype=np.uint8)


@lru_cache(maxsize=1)
def luminance_scale() -> Colours:
    """The 54 colours (54, 3) of values from 1 to 10^6."""
    return np.concatenate([_sampled(hue, np.linspace(0.0, _PALEST, _STEPS)) for hue in _HUES])


@lru_cache(maxsize=1)
def error_scale() -> Colours:
    """The 41 colours (41, 3) of relative errors, the middle one white."""
    return _sampled("RdBu_r", np.linspace(0.0, 1.0, _ERROR_STEPS))


def luminance_colours(value: ArrayLike) -> Colours:
    """Colours (..., 3) of luminances in cd m^-2, or of percents of another, (...,).

    A step holds from one multiple of a power of ten to the next: 300 to 400, say. Red below 1
    and yellow from 10^6 on.
    """
    values = np.asarray(value, dtype=float)
    # What is not a number is below, too.
    within = np.clip(np.nan_to_num(values), 1.0, 10.0**DECADES)
    decade = np.minimum(np.floor(np.log10(within)).astype(int), DECADES - 1)
    step = np.clip((within / 10.0**decade).astype(int) - 1, 0, _STEPS - 1)
    colours = luminance_scale()[_STEPS * decade + step]
    colours = np.where((values >= 1.0)[..., None], colours, _BELOW)
    return np.where((values >= 10.0**DECADES)[..., None], _ABOVE, colours)


def error_colours(relative_error: ArrayLike) -> Colours:
    """Colours (..., 3) of relative errors (...,), 1 for 100 %: held beyond -2 and 2."""
    # Rounding in 10 e must not move a whole multiple of 10 % to the step below.
    step = np.floor(10.0 * np.asarray(relative_error, dtype=float) + 1e-9) + _ERROR_STEPS // 2
    return error_scale()[np.clip(step, 0, _ERROR_STEPS - 1).astype(int)]


def _sampled(name: str, places: NDArray[np.float64]) -> Colours:
    from matplotlib import colormaps

    return np.asarray(colormaps[name](places)[:, :3] * 255.0).round().astype(np.uint8)

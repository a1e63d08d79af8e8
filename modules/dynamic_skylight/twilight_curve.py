"""Illuminance of level ground under a low or set sun: a published curve."""

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray

# Seidelmann (ed.), Explanatory Supplement to the Astronomical Almanac (1992), p. 491: upper
# end of each piece in degrees, then l0..l3 of log10 E[lux] = l0 + l1 x + l2 x^2 + l3 x^3,
# x = elevation / 90 deg.
_PIECES = (
    (20.0, (3.05, 13.28, -45.98, 64.33)),
    (5.0, (2.88, 22.26, -207.64, 1034.30)),
    (-0.8, (2.88, 21.81, -258.11, -858.36)),
    (-5.0, (2.70, 12.17, -431.69, -1899.83)),
    (-12.0, (13.84, 262.72, 1447.42, 2797.93)),
)
NIGHT_BEGINS_DEG = -18.0


def illuminance_lx(elevation_deg: ArrayLike) -> FloatArray:
    """Illuminance (...,) of level ground by sun and sky, lux, for a sun from -18 to 20 deg.

    Outside this range the values at its ends hold. As published, except for steps of up to 1 %
    between pieces: each piece is scaled to meet the next, starting from the one at the horizon.
    """
    (top, day), (upper_of_horizon, horizon) = _PIECES[:2]
    e = np.clip(np.asarray(elevation_deg, dtype=float), NIGHT_BEGINS_DEG, top)
    step = float(_cubic(upper_of_horizon, horizon) - _cubic(upper_of_horizon, day))
    logarithm = _cubic(e, day) + step
    for (_, above), (upper, cubic) in pairwise(_PIECES):
        step += float(_cubic(upper, above) - _cubic(upper, cubic))
        logarithm = np.where(e < upper, _cubic(e, cubic) + step, logarithm)
    return 10.0**logarithm


def _cubic(elevation_deg: ArrayLike, coefficients: tuple[float, ...]) -> FloatArray:
    x = np.asarray(elevation_deg, dtype=float) / 90.0
    return np.asarray(np.polynomial.polynomial.polyval(x, coefficients))

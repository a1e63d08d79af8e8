"""How bright the ground is below the sun's horizon, and how blue: published curves, no sky."""

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

# Seidelmann (ed.), Explanatory Supplement to the Astronomical Almanac (1992), p. 491: upper
# end of each piece in degrees, then l0..l3 of log10 E[lux] = l0 + l1 x + l2 x^2 + l3 x^3,
# x = elevation / 90 deg.
_PIECES = (
    (5.0, (2.88, 22.26, -207.64, 1034.30)),
    (-0.8, (2.88, 21.81, -258.11, -858.36)),
    (-5.0, (2.70, 12.17, -431.69, -1899.83)),
    (-12.0, (13.84, 262.72, 1447.42, 2797.93)),
)
NIGHT_BEGINS_DEG = -18.0
# Optical depths of 300 Dobson units of ozone at 610, 550 and 465 nm (Chappuis band, cross
# sections of Serdyuchenko et al. 2014), where linear sRGB's primaries have their weight.
_OZONE_DEPTH_RGB = np.array([0.037, 0.027, 0.003])
# Light of the twilight sky has crossed the ozone layer along a slant this many times as long
# as the vertical (Hulburt 1953 puts it near 25 for a sun 6 deg below the horizon).
_OZONE_SLANT = 25.0
_SLANT_REACHED_DEG = -6.0


def illuminance_lx(elevation_deg: ArrayLike) -> FloatArray:
    """Twilight's illuminance (...,) on level ground, lux, for a sun from -18 to 5 deg.

    As published, but for the small steps (up to 1 %) where pieces meet: each piece is scaled to
    go on from the one above it. Held outside the range.
    """
    e = np.clip(np.asarray(elevation_deg, dtype=float), NIGHT_BEGINS_DEG, _PIECES[0][0])
    logarithm, step = _cubic(e, _PIECES[0][1]), 0.0
    for (_, above), (upper, cubic) in pairwise(_PIECES):
        step += float(_cubic(upper, above) - _cubic(upper, cubic))
        logarithm = np.where(e < upper, _cubic(e, cubic) + step, logarithm)
    return 10.0**logarithm


def ozone_tint(elevation_deg: ArrayLike, begins_deg: float) -> FloatArray:
    """RGB factors (..., 3) of the blue hour: ozone's absorption, growing as the sun sinks.

    1 at `begins_deg` and above, full from -6 deg down. The luminance is for the caller to keep.
    """
    e = np.asarray(elevation_deg, dtype=float)
    x = np.clip((begins_deg - e) / (begins_deg - _SLANT_REACHED_DEG), 0.0, 1.0)
    slant = _OZONE_SLANT * x * x * (3.0 - 2.0 * x)
    return np.exp(-slant[..., None] * _OZONE_DEPTH_RGB)


def _cubic(elevation_deg: ArrayLike, coefficients: tuple[float, ...]) -> FloatArray:
    x = np.asarray(elevation_deg, dtype=float) / 90.0
    return np.asarray(np.polynomial.polynomial.polyval(x, coefficients))

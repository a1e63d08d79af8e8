"""The colour of weather, which neither CIE's nor Perez's sky has: a stated model.

Clear sky of luminance L has the correlated colour temperature 1e6 / (59.77 log10 L - 132.1) K, at
most 25,000 K, cloud 6514 K: what Chain, Dumortier and Fontoynont measured (1999, Solar Energy 65,
285). Between them their light mixes by Perez's clearness. All lie on CIE's daylight locus (CIE 15).
RGB is luminance / 683 of that colour, so that Y stays what the photometry says. The red of dusk
and the ring around the sun are not in it.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.geometry.colour import LUMENS_PER_WATT, SRGB_FROM_XYZ
from vrut_lite.numeric_types import FloatArray

CLOUD_K, BLUEST_K = 6514.0, 25_000.0
# Colour temperature (K) of deep twilight, one constant.
TWILIGHT_K = 10_000.0
_OVERCAST_UP_TO, _CLEAR_FROM = 1.065, 6.2


def clear_share(clearness: ArrayLike) -> FloatArray:
    """Share (...,) of light that has the colour of clear sky, by Perez's clearness."""
    way = np.log(np.asarray(clearness, dtype=float) / _OVERCAST_UP_TO)
    return np.clip(way / np.log(_CLEAR_FROM / _OVERCAST_UP_TO), 0.0, 1.0)


def sky_rgb(luminance_cd_m2: ArrayLike, clear: ArrayLike) -> FloatArray:
    """Radiance (..., 3), linear sRGB in W m^-2 sr^-1, of sky of a luminance and clear share."""
    luminance = np.asarray(luminance_cd_m2, dtype=float)
    mired = 59.77 * np.log10(np.maximum(luminance, 1.0)) - 132.1
    kelvin = 1e6 / np.maximum(mired, 1e6 / BLUEST_K)
    share = np.asarray(clear, dtype=float)[..., None]
    mixed = share * rgb_of_daylight(kelvin) + (1.0 - share) * rgb_of_daylight(CLOUD_K)
    return mixed * (luminance / LUMENS_PER_WATT)[..., None]


def rgb_of_daylight(kelvin: ArrayLike) -> FloatArray:
    """Linear sRGB (..., 3) of luminance 1 on the daylight locus, from 4000 to 25,000 K."""
    mired, rgb = _locus()
    at = 1e6 / np.clip(kelvin, 4000.0, BLUEST_K)
    return np.stack([np.interp(at, mired, channel) for channel in rgb.T], axis=-1)


@lru_cache(maxsize=1)
def _locus() -> tuple[FloatArray, FloatArray]:
    """Reciprocal temperatures (n,) in 1e6 / K, rising, and the linear sRGB (n, 3) of Y = 1."""
    mired = np.linspace(40.0, 250.0, 106)
    t = 1000.0 / (1e6 / mired)
    warm = 0.244063 + 0.09911 * t + 2.9678 * t**2 - 4.6070 * t**3
    cold = 0.237040 + 0.24748 * t + 1.9018 * t**2 - 2.0064 * t**3
    x = np.where(1000.0 / t <= 7000.0, warm, cold)
    y = -3.0 * x * x + 2.870 * x - 0.275
    xyz = np.stack([x / y, np.ones_like(x), (1.0 - x - y) / y], axis=-1)
    return mired, np.maximum(xyz @ SRGB_FROM_XYZ.T, 0.0)

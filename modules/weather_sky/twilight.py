"""The light of level ground while the sun is below the horizon, by the sun's elevation alone."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.numeric_types import FloatArray

# P. K. Seidelmann (ed.) 1992, Explanatory Supplement to the Astronomical Almanac, table 9.10-1:
# log10 lux as a cubic of elevation / 90 degrees, for suns from each elevation up.
_FROM_DEG = np.array([-18.0, -12.0, -5.0, -0.8])
_TERMS = np.array([
    [13.84, 262.72, 1447.42, 2797.93], [2.70, 12.17, -431.69, -1899.83],
    [2.88, 21.81, -258.11, -858.36], [2.88, 22.26, -207.64, 1034.30],
])  # fmt: skip
_HIGHEST_DEG = 5.0


def twilight_lux(elevation_rad: ArrayLike) -> FloatArray:
    """Illuminance (...,) of level ground in lux; from 18 degrees below the horizon on a constant.

    Above 5 degrees it stays what it is there: by day measurements say the light.
    """
    degrees = np.clip(np.degrees(np.asarray(elevation_rad, dtype=float)), -18.0, _HIGHEST_DEG)
    row = np.clip(np.searchsorted(_FROM_DEG, degrees, side="right") - 1, 0, 3)
    x = degrees[..., None] / 90.0
    return np.asarray(10.0 ** (_TERMS[row] * x ** np.arange(4)).sum(axis=-1))


def twilight_alone(
    elevation_rad: ArrayLike, direct_normal_w_m2: ArrayLike, diffuse_horizontal_w_m2: ArrayLike
) -> NDArray[np.bool_]:
    """Whether hours (...,) have twilight's light instead of measured light.

    The sun is down, or below 5 degrees with both irradiances 0: files round to whole watts. Higher
    up, 0 is a measured value.
    """
    elevation = np.asarray(elevation_rad, dtype=float)
    none = (np.asarray(direct_normal_w_m2) <= 0.0) & (np.asarray(diffuse_horizontal_w_m2) <= 0.0)
    return (elevation <= 0.0) | (none & (elevation < np.radians(_HIGHEST_DEG)))

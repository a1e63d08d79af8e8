"""The light of an overcast sky: functions of numbers and arrays, without messages."""

import numpy as np
from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.numeric_types import FloatArray

# Degrees of the sun below the horizon over which twilight dims to a tenth: from hundreds of lux at
# sunset to a few at -6 degrees.
_DECADE_DEG = 3.0


def illuminance_lx(elevation_rad: float) -> float:
    """Illuminance of level ground under an overcast sky, lx.

    300 + 21000 sin(elevation): Krochmann and Seidl, Quantitative data on daylight for illuminating
    engineering, Lighting Research and Technology 6 (1974), 165-171.
    """
    by_day = 300.0 + 21_000.0 * max(np.sin(elevation_rad), 0.0)
    return float(by_day * 10.0 ** (min(np.degrees(elevation_rad), 0.0) / _DECADE_DEG))


def radiance(horizontal_lx: float, sine: FloatArray) -> FloatArray:
    """Linear sRGB (..., 3), W m^-2 sr^-1, at sines of elevation (...,); white as D65.

    The luminance is the zenith's times (1 + 2 sine) / 3: Moon and Spencer, Illumination from a
    non-uniform sky, Illuminating Engineering 37 (1942), 707-726. Below the horizon it is that of
    the horizon.
    """
    # The integral of the distribution times the sine over the hemisphere is 7 pi / 9.
    zenith_cd_m2 = 9.0 / (7.0 * np.pi) * horizontal_lx
    luminance = zenith_cd_m2 * (1.0 + 2.0 * np.maximum(sine, 0.0)) / 3.0
    return np.repeat(luminance[..., None] / LUMENS_PER_WATT, 3, axis=-1)

"""Vision of the dark-adapted eye: rods see no colour, are sensitive to blue and resolve less.

How far rods and cones share follows CIE 191:2010: its adaptation coefficient m is linear in the
logarithm of the mesopic luminance, 1 from 5 cd m^-2 up and 0 from 0.005 down, and the luminance is
that by m V + (1 - m) V'. For daylight (a scotopic over photopic ratio of 2.47) m is linear in the
logarithm of the photopic luminance too, within 0.014; for incandescent lamps (1.4) within 0.075.
Ward Larson, Rushmeier and Piatko (1997, IEEE Trans. Vis. Comp. Graph. 3, 291) give the scotopic
luminance from XYZ; it is divided by that of daylight's white, so that white stays as bright.

A pixel's adaptation luminance is its own (Uchida 2017: adaptation is local), at least the
picture's: eyes adapt to a lamp in an instant and to the dark corner beside it in minutes.

Rods add to the achromatic signal, as Ward Larson and others have it: colours fade towards grey.
Where rods see alone their grey is bluish as in paintings of moonlit scenes, x = y = 0.25 (Jensen et
al. 2000, "Night Rendering"); between, the hue goes over with 1 - m, which is our choice.

Acuity falls with luminance: Ward Larson and others fit Shlaer's data (1937), here the frequency at
which a Gaussian around each pixel halves the contrast. Its width follows the mean light of the
pixel and its neighbours, up to three pixels: a picture of a narrow view magnifies, as a telescope
does. The twin is in shaders/tone_map.frag.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT, SRGB_FROM_XYZ, luminance
from vrut_lite.messages.picture import NightLook
from vrut_lite.numeric_types import FloatArray
from vrut_lite.pictures.exposure import metered_cd

XYZ_FROM_SRGB = np.linalg.inv(SRGB_FROM_XYZ)
# Luminance (cd m^-2) of daylight below which rods see alone, and above which cones do: 0.005 of CIE
# 191 by V' with its maximum at 683 lm/W instead of 1699, and 5.
RODS_ALONE_CD, CONES_ALONE_CD = 0.005 * 683.0 / 1699.0, 5.0
# Scotopic luminance of daylight's white over its luminance; divided by it, white stays as bright.
_OF_WHITE = 2.57
# Linear sRGB for a scotopic luminance of 1: beside cones, and of x = y = 0.25 where rods see alone.
RODS_GREY_RGB = np.full(3, 1.0 / _OF_WHITE)
RODS_BLUE_RGB = SRGB_FROM_XYZ @ np.array([1.0, 1.0, 2.0]) / _OF_WHITE
# Luminance (cd m^-2) below any light, for logarithms.
_DARK = 1e-20
# Coefficients of acuity (cycles a degree) by log luminance (cd m^-2), and the least acuity.
ACUITY, LEAST_CYCLES = (17.25, 1.4, 0.35, 25.72), 0.7
# Standard deviation in degrees, times cycles a degree, of the Gaussian that halves the contrast.
_HALVES = math.sqrt(0.5 * math.log(2.0)) / math.pi
# Radius of the sum in deviations, its limit in pixels, and the deviation (px) below which no blur
# is done.
DEVIATIONS, _MOST_PX, SHARP_PX = 2.0, 6, 0.2


def adapted_cd(ev100: float, night_look: NightLook) -> float | None:
    """Luminance (cd m^-2) to which the eye is adapted in a picture of this exposure.

    None if cones see alone: by day, or to a camera.
    """
    field_cd = metered_cd(ev100, night_look)
    return None if night_look == "exposure" or field_cd >= CONES_ALONE_CD else field_cd


def blur_px(pixel_rad: float) -> tuple[float, int]:
    """Deviation in pixels times cycles a degree, and the radius of the sum in pixels.

    `pixel_rad`: the angle that a pixel sees; 0 for no blur.
    """
    if pixel_rad <= 0.0:
        return 0.0, 0
    per_cycle = _HALVES / math.degrees(pixel_rad)
    widest = per_cycle / LEAST_CYCLES
    if widest < SHARP_PX:
        return per_cycle, 0
    return per_cycle, min(math.ceil(DEVIATIONS * widest), _MOST_PX)


def as_sharp_as_seen(
    radiance_rgb: NDArray[np.floating], pixel_rad: float, field_cd: float = 0.0
) -> FloatArray:
    """A picture (h, w, 3) in W m^-2 sr^-1, blurred to the eye's acuity in its light.

    `field_cd`: see `adapted_cd`.
    """
    rgb = np.asarray(radiance_rgb, dtype=float)
    per_cycle, reach = blur_px(pixel_rad)
    if reach == 0:
        return rgb
    light = np.pad(luminance(rgb), 1, mode="edge")
    rows, columns = rgb.shape[:2]
    mean = sum(light[i : i + rows, j : j + columns] for i in range(3) for j in range(3)) / 9.0
    a, b, c, d = ACUITY
    decades = np.log10(np.maximum(mean * LUMENS_PER_WATT, max(field_cd, _DARK)))
    deviation = per_cycle / np.maximum(a * np.arctan(b * decades + c) + d, LEAST_CYCLES)
    deviation = np.minimum(deviation, reach / DEVIATIONS)
    near = np.ceil(DEVIATIONS * deviation)
    padded = np.pad(rgb, ((reach, reach), (reach, reach), (0, 0)), mode="edge")
    total, weights = np.zeros_like(rgb), np.zeros((rows, columns, 1))
    for i in range(-reach, reach + 1):
        for j in range(-reach, reach + 1):
            weight = np.exp(-0.5 * (i * i + j * j) / np.maximum(deviation, 1e-3) ** 2)[..., None]
            weight = np.where((i * i + j * j <= near * near)[..., None], weight, 0.0)
            y, x = reach + i, reach + j
            total += weight * padded[y : y + rows, x : x + columns]
            weights += weight
    return np.where((deviation < SHARP_PX)[..., None], rgb, total / weights)


def seen_by_eye(radiance_rgb: ArrayLike, field_cd: float = 0.0) -> FloatArray:
    """Linear sRGB (..., 3) in W m^-2 sr^-1 that a camera would need to show what the eye sees.

    `field_cd`: see `adapted_cd`.
    """
    rgb = np.asarray(radiance_rgb, dtype=float)
    x, y, z = np.moveaxis(np.maximum(rgb @ XYZ_FROM_SRGB.T, _DARK), -1, 0)
    scotopic = y * np.maximum(1.33 * (1.0 + (y + z) / x) - 1.68, 0.0)
    adapted = np.log(np.maximum(y * LUMENS_PER_WATT, field_cd) / RODS_ALONE_CD)
    rods = 1.0 - np.clip(adapted / np.log(CONES_ALONE_CD / RODS_ALONE_CD), 0.0, 1.0)[..., None]
    grey = (1.0 - rods) * RODS_GREY_RGB + rods * RODS_BLUE_RGB
    return np.asarray((1.0 - rods) * rgb + rods * scotopic[..., None] * grey)

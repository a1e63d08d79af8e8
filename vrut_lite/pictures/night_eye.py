"""What the dark-adapted eye makes of night: rods see brightness without colour, and blue as bright.

Ward Larson, Rushmeier and Piatko (1997, IEEE Trans. Vis. Comp. Graph. 3, 291) have the scotopic
luminance by XYZ, and the limits between which rods and cones both see; between them the share goes
by the logarithm here. Rods' grey has the blue of moonlit scenes as painters and observers have it,
x = y = 0.25 (Jensen et al. 2000, "Night Rendering"). Shapes stay as sharp as a camera's. The twin
is in shaders/tone_map.frag.
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.geometry.colour import LUMENS_PER_WATT, SRGB_FROM_XYZ
from vrut_lite.numeric_types import FloatArray

XYZ_FROM_SRGB = np.linalg.inv(SRGB_FROM_XYZ)
# Luminance (cd m^-2) below which rods see alone, and above which cones do.
RODS_ALONE_CD, CONES_ALONE_CD = 5.6e-3, 5.6
# Scotopic luminance of daylight's white over its luminance: so white stays as bright.
_OF_WHITE = 2.57
# Linear sRGB of x = y = 0.25, for a scotopic luminance of 1.
RODS_RGB = SRGB_FROM_XYZ @ np.array([1.0, 1.0, 2.0]) / _OF_WHITE
# Less than any light.
_DARK = 1e-20


def seen_by_eye(radiance_rgb: ArrayLike) -> FloatArray:
    """Linear sRGB (..., 3) in W m^-2 sr^-1 that a camera would need to show what the eye sees."""
    rgb = np.asarray(radiance_rgb, dtype=float)
    x, y, z = np.moveaxis(np.maximum(rgb @ XYZ_FROM_SRGB.T, _DARK), -1, 0)
    scotopic = y * np.maximum(1.33 * (1.0 + (y + z) / x) - 1.68, 0.0)
    cones = np.log(y * LUMENS_PER_WATT / RODS_ALONE_CD) / np.log(CONES_ALONE_CD / RODS_ALONE_CD)
    share = np.clip(cones, 0.0, 1.0)[..., None]
    return np.asarray(share * rgb + (1.0 - share) * scotopic[..., None] * RODS_RGB)

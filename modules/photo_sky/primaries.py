"""Linear RGB of other primaries, and CIE XYZ, as linear sRGB; white stays white.

A picture's white is its own grey: it is adapted to that of sRGB by Bradford's cone responses
(ICC.1, annex E), as Radiance and programs for EXR do. RGB (1, 1, 1) keeps its luminance of 1.
"""

import numpy as np

from vrut_lite.geometry.colour import SRGB_CHROMATICITIES, SRGB_FROM_XYZ
from vrut_lite.numeric_types import FloatArray

_SAME = 2e-4
_EQUAL_ENERGY = np.ones(3)
_CONES = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def rgb_from_primaries(values: FloatArray, primaries: tuple[float, ...]) -> FloatArray:
    """Linear sRGB (..., 3) of RGB (..., 3) whose primaries and white (8,) are x and y in turn.

    Raises:
        ValueError: the chromaticities span no colours.
    """
    xy = np.array(primaries, dtype=float)
    if xy.shape != (8,) or not np.isfinite(xy).all():
        raise ValueError("no primaries")
    if np.abs(xy - SRGB_CHROMATICITIES).max() <= _SAME:
        return values
    x, y = xy[::2], xy[1::2]
    if np.abs(y).min() < 1e-6:
        raise ValueError("no primaries")
    xyz = np.stack([x / y, np.ones(4), (1.0 - x - y) / y])
    luminances = np.linalg.solve(xyz[:, :3], xyz[:, 3])
    matrix = _adapted(xyz[:, 3]) @ (xyz[:, :3] * luminances)
    if not np.isfinite(matrix).all() or np.abs(matrix).max() > 1e3:
        raise ValueError("no primaries")
    return np.asarray(values @ matrix.T)


def rgb_from_xyz(values: FloatArray) -> FloatArray:
    """Linear sRGB (..., 3) of CIE XYZ (..., 3) whose grey is of equal energy, as Radiance's is."""
    return np.asarray(values @ _adapted(_EQUAL_ENERGY).T)


def _adapted(white_xyz: FloatArray) -> FloatArray:
    """Matrix (3, 3) from XYZ with this white (3,) to linear sRGB."""
    cones = _CONES @ (np.linalg.inv(SRGB_FROM_XYZ) @ np.ones(3)) / (_CONES @ white_xyz)
    return SRGB_FROM_XYZ @ np.linalg.inv(_CONES) @ (cones[:, None] * _CONES)

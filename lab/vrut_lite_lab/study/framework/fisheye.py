"""The round pictures of a whole sky: zenith in the middle, north at the bottom, east right.

Zenith angle grows evenly from the middle to the rim (Bruneton 2016, section 7).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.directions import directions

Picture = NDArray[np.uint8]

SIZE = 256
_RED = np.array([255, 0, 0])
_CROSS_ARM = 5
_MARK_STRENGTH = 64.0 / 255.0


class SkyPixels(NamedTuple):
    """Zenith angle and azimuth (n,) in rad of a picture's pixels that show sky.

    `rows` and `columns` (n,) say where they are, row 0 on top.
    """

    size: int
    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    zenith_rad: FloatArray
    azimuth_rad: FloatArray


def pixels(size: int = SIZE) -> SkyPixels:
    """The pixels inside the circle of a square picture."""
    half = size / 2.0
    rows, columns = np.indices((size, size))
    x, up = (columns + 0.5 - half) / half, (half - 0.5 - rows) / half
    radius = np.hypot(x, up)
    inside = radius < 1.0
    azimuth = np.mod(np.arctan2(x, -up), 2.0 * np.pi)
    where = rows[inside], columns[inside]
    return SkyPixels(size, *where, radius[inside] * np.pi / 2.0, azimuth[inside])


def picture(at: SkyPixels, colours: NDArray[np.generic], around: int = 255) -> Picture:
    """A picture (size, size, 3) of colours (n, 3): bytes, or fractions of white in 0 to 1.

    Fractions are cut, not rounded, to bytes, as published; `around` is the grey of the rest.
    """
    painted = np.full((at.size, at.size, 3), around, dtype=np.uint8)
    is_fraction = np.issubdtype(colours.dtype, np.floating)
    values = np.clip(colours, 0.0, 1.0) * 255.0 if is_fraction else colours
    painted[at.rows, at.columns] = values.astype(np.uint8)
    return painted


def position(size: int, zenith_rad: float, azimuth_rad: float) -> tuple[int, int]:
    """Row and column of the pixel that shows a direction."""
    radius = zenith_rad / (np.pi / 2.0)
    right, down = radius * np.sin(azimuth_rad), radius * np.cos(azimuth_rad)
    half = size / 2.0
    return int(down * half + half - 0.5), int(right * half + half - 0.5)


def mark(painted: Picture, sun_zenith_rad: float, sun_azimuth_rad: float) -> None:
    """Draw the sun as a red cross, and the 81 directions as faint dots, into a picture.

    A sun below the horizon is not drawn.
    """
    size = len(painted)
    for zenith, azimuth in zip(*directions(), strict=True):
        spot = position(size, zenith, azimuth)
        painted[spot] = (painted[spot] * (1.0 - _MARK_STRENGTH)).astype(np.uint8)
    if sun_zenith_rad <= np.pi / 2.0:
        row, column = position(size, sun_zenith_rad, sun_azimuth_rad)
        painted[max(row - _CROSS_ARM, 0) : row + _CROSS_ARM + 1, column] = _RED
        painted[row, max(column - _CROSS_ARM, 0) : column + _CROSS_ARM + 1] = _RED

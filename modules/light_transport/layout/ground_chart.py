"""The ground disc's texels: fine below the scene, coarse far away."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.messages.light_map import GroundChart
from vrut_lite.numeric_types import FloatArray

EDGE_PX = 96
# In the middle texels are a tenth as wide as they are at the edge.
_WARP = 3.0
_RADII = 4.0
# Below a scene of a single point.
_LEAST_WIDTH_M = 1e-6


def ground_chart(
    disc: GroundDisc, scene_radius_m: float, corner_px: tuple[int, int]
) -> GroundChart:
    """The chart of a disc below a scene, at a corner of the map."""
    half_width_m = max(min(_RADII * scene_radius_m, disc.radius_m), _LEAST_WIDTH_M)
    return GroundChart(corner_px=corner_px, edge_px=EDGE_PX, half_width_m=half_width_m, warp=_WARP)


def ground_uv_px(chart: GroundChart, disc: GroundDisc, xz_m: ArrayLike) -> FloatArray:
    """Where points (..., 2), x and z in world axes, lie in the map, in texels (..., 2).

    Points beyond the chart get its outermost texels.
    """
    away = (np.asarray(xz_m, dtype=float) - disc.centre_xz_m) / chart.half_width_m
    warped = np.arcsinh(math.sinh(chart.warp) * np.clip(away, -1.0, 1.0)) / chart.warp
    at = 0.5 * (1.0 + warped) * (chart.edge_px - 1)
    return np.asarray(np.add(chart.corner_px, 0.5 + at))


def ground_xz_m(chart: GroundChart, disc: GroundDisc, uv_px: ArrayLike) -> FloatArray:
    """Where places (..., 2) of the map lie on the ground: x and z (..., 2) in world axes.

    Places up to half a texel beyond the outermost middles lie beyond the chart's width.
    """
    at = np.subtract(uv_px, chart.corner_px) - 0.5
    warped = 2.0 * at / (chart.edge_px - 1) - 1.0
    away = np.sinh(chart.warp * warped) / math.sinh(chart.warp)
    return np.asarray(disc.centre_xz_m + chart.half_width_m * away)


def ground_owners(first_triangle: int) -> NDArray[np.int32]:
    """The ground's triangle below each texel: the square's halves south-west and north-east."""
    row, column = np.indices((EDGE_PX, EDGE_PX))
    return np.asarray(first_triangle + (column > row), np.int32)

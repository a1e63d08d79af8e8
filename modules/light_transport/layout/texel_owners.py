"""The triangle that each texel lies in, and the place of a triangle nearest to a texel."""

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import inlined, kernel
from vrut_lite.numeric_types import FloatArray

UNUSED = -1
# A bilinear look-up on a triangle meets texels whose middles lie less than one texel across and one
# down beside it: 1.42 along the diagonal, and what `unwrapping.MARGIN_PX` adds.
REACH_PX = 1.51


def texel_owners(
    uv_px: FloatArray,
    chart: NDArray[np.int32],
    corners: NDArray[np.int32],
    sizes: NDArray[np.int32],
    size: tuple[int, int],
) -> NDArray[np.int32]:
    """The triangle under each texel's middle, else the nearest one of the texel's chart.

    Args:
        uv_px: (F, 3, 2), from the corner of the whole.
        chart: (F,), of triangles.
        corners, sizes: (C, 2), the charts' rectangles in the whole.
        size: width and height of the whole.

    Returns:
        (height, width) int32: numbers of triangles, `UNUSED` where no look-up gets.
    """
    return np.asarray(_owners(uv_px, chart, corners, sizes, size[0], size[1]))


@kernel
def _owners(uv, chart, corners, sizes, width, height):  # type: ignore[no-untyped-def]
    owner = np.full((height, width), UNUSED, np.int32)
    nearest2 = np.full((height, width), REACH_PX * REACH_PX)
    level = np.zeros(3)
    for f in range(len(uv)):
        a = uv[f]
        c = chart[f]
        low_x, high_x = min(a[0, 0], a[1, 0], a[2, 0]), max(a[0, 0], a[1, 0], a[2, 0])
        low_y, high_y = min(a[0, 1], a[1, 1], a[2, 1]), max(a[0, 1], a[1, 1], a[2, 1])
        left = max(int(np.floor(low_x - REACH_PX)), corners[c, 0])
        right = min(int(np.ceil(high_x + REACH_PX)), corners[c, 0] + sizes[c, 0])
        top = max(int(np.floor(low_y - REACH_PX)), corners[c, 1])
        bottom = min(int(np.ceil(high_y + REACH_PX)), corners[c, 1] + sizes[c, 1])
        for y in range(top, bottom):
            for x in range(left, right):
                if nearest2[y, x] > 0.0:
                    distance2 = nearest(a, level, x + 0.5, y + 0.5)[0]
                    # Among equally near ones the first.
                    if distance2 < nearest2[y, x]:
                        nearest2[y, x], owner[y, x] = distance2, f
    return owner


@inlined
def nearest(corners, heights, x, y):  # type: ignore[no-untyped-def]
    """Square of the distance of (x, y) from a triangle, 0 within, and the nearest place's height.

    `corners` (3, 2), `heights` (3,): of these corners.
    """
    area = signed_area(corners[0], corners[1], corners[2, 0], corners[2, 1])
    inside = area != 0.0
    least, height, within = np.inf, 0.0, 0.0
    for e in range(3):
        a, b = corners[e], corners[(e + 1) % 3]
        side = signed_area(a, b, x, y)
        if side * area < 0.0:
            inside = False
        within += side * heights[(e + 2) % 3]
        du, dv = b[0] - a[0], b[1] - a[1]
        along, length2 = (x - a[0]) * du + (y - a[1]) * dv, du * du + dv * dv
        share = min(max(along / length2, 0.0), 1.0) if length2 > 0.0 else 0.0
        across, down = x - a[0] - share * du, y - a[1] - share * dv
        distance2 = across * across + down * down
        if distance2 < least:
            least = distance2
            height = heights[e] + share * (heights[(e + 1) % 3] - heights[e])
    if inside:
        return 0.0, within / area
    return least, height


@inlined
def signed_area(a, b, x, y):  # type: ignore[no-untyped-def]
    """Twice the area of the triangle a, b, (x, y).

    Exact for coordinates of `unwrapping.STEPS_PER_PX` and middles of texels.
    """
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])

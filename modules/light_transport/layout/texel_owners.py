"""Finds the triangle that each texel lies in."""

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import kernel
from light_transport.layout.nearest_place import REACH_PX, nearest
from vrut_lite.numeric_types import FloatArray

UNUSED = -1


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

"""The place of a flat triangle nearest to a texel's middle."""

import numpy as np

from light_transport.kernels import inlined

# A bilinear look-up on a triangle meets texels whose middles lie less than one texel across and one
# down beside it: 1.42 along the diagonal, and what `projection.MARGIN_PX` adds.
REACH_PX = 1.51


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

    Exact for coordinates of `projection.STEPS_PER_PX` and middles of texels.
    """
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])

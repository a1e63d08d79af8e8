"""Rectangles into a rectangle: the skyline's lowest place, largest first.

After Jylänki 2010, "A Thousand Ways to Pack the Bin" (skyline, bottom-left).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import kernel

# Widths that are tried, in edges of the square that would just hold all.
_WIDTHS = (1.03, 0.75, 0.85, 0.95, 1.1, 1.2, 1.35)
# Number of rectangles above which only the first width is tried: small ones fill the gaps.
_MANY = 2000


class PackedRectangles(NamedTuple):
    """Corners (N, 2) int32 of rectangles, and the width and height that hold them."""

    corners: NDArray[np.int32]
    size: tuple[int, int]


def pack(sizes: NDArray[np.int32], widest: int) -> PackedRectangles:
    """Places for rectangles of these sizes (N, 2), none of which overlap.

    Args:
        sizes: width and height of each, at least one.
        widest: no place reaches beyond it, unless a rectangle is wider itself.
    """
    if not len(sizes):
        return PackedRectangles(np.empty((0, 2), np.int32), (0, 0))
    edge = math.sqrt(float(np.prod(sizes.astype(np.int64), axis=1).sum()))
    order = np.lexsort((-sizes[:, 0], -sizes[:, 1])).astype(np.int64)
    tried = [
        _packed(sizes, order, min(math.ceil(width * edge), widest))
        for width in (_WIDTHS if len(sizes) <= _MANY else _WIDTHS[:1])
    ]
    return min(tried, key=lambda packed: packed.size[0] * packed.size[1])


def _packed(sizes: NDArray[np.int32], order: NDArray[np.int64], width: int) -> PackedRectangles:
    width = max(width, int(sizes[:, 0].max()))
    corners = _skyline(np.ascontiguousarray(sizes, np.int64), order, width)
    far = (corners + sizes).max(axis=0)
    return PackedRectangles(corners.astype(np.int32), (int(far[0]), int(far[1])))


@kernel
def _skyline(sizes, order, width):  # type: ignore[no-untyped-def]
    corners = np.empty((len(sizes), 2), np.int64)
    # Steps of the skyline: where each begins, and its height.
    start = np.empty(width + 2, np.int64)
    height = np.empty(width + 2, np.int64)
    start[0], height[0], steps = 0, 0, 1
    for number in order:
        wide, high = sizes[number, 0], sizes[number, 1]
        best, best_top = -1, np.int64(2**62)
        for i in range(steps):
            if start[i] + wide > width:
                break
            top, j = np.int64(0), i
            while j < steps and start[j] < start[i] + wide and top < best_top:
                top = max(top, height[j])
                j += 1
            if top < best_top:
                best, best_top = i, top
        left, right = start[best], start[best] + wide
        corners[number, 0], corners[number, 1] = left, best_top
        # The steps under it become one; the last keeps what sticks out.
        last = best
        while last + 1 < steps and start[last + 1] < right:
            last += 1
        end = start[last + 1] if last + 1 < steps else width
        rest = height[last]
        added = 2 if end > right else 1
        shift = added - (last - best + 1)
        if shift > 0:
            for i in range(steps - 1, last, -1):
                start[i + shift], height[i + shift] = start[i], height[i]
        elif shift < 0:
            for i in range(last + 1, steps):
                start[i + shift], height[i + shift] = start[i], height[i]
        steps += shift
        start[best], height[best] = left, best_top + high
        if added == 2:
            start[best + 1], height[best + 1] = right, rest
    return corners

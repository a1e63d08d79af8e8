"""Rectangles into a rectangle: the skyline's lowest place, largest first.

After Jylänki 2010, "A Thousand Ways to Pack the Bin" (skyline, bottom-left).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import kernel

# Room left between rectangles, as a share of their area, when the width is chosen.
_WASTE = 1.06


class Packed(NamedTuple):
    """Corners (N, 2) int32 of rectangles, and the width and height that hold them."""

    corners: NDArray[np.int32]
    size: tuple[int, int]


def pack(sizes: NDArray[np.int32], widest: int, aspect: float = 1.0) -> Packed:
    """Places for rectangles of these sizes (N, 2), none of which overlap.

    Args:
        sizes: width and height of each, at least one.
        widest: no place reaches beyond it, unless a rectangle is wider itself.
        aspect: width over height that the whole should have.
    """
    if not len(sizes):
        return Packed(np.empty((0, 2), np.int32), (0, 0))
    area = float(np.prod(sizes.astype(np.int64), axis=1).sum())
    wanted = math.ceil(math.sqrt(_WASTE * area * aspect))
    width = max(int(sizes[:, 0].max()), min(wanted, widest))
    order = np.lexsort((-sizes[:, 0], -sizes[:, 1])).astype(np.int64)
    corners = _skyline(np.ascontiguousarray(sizes, np.int64), order, width)
    far = (corners + sizes).max(axis=0)
    return Packed(corners.astype(np.int32), (int(far[0]), int(far[1])))


@kernel
def _skyline(sizes, order, width):  # type: ignore[no-untyped-def]
    corners = np.empty((len(sizes), 2), np.int64)
    # Steps of the skyline: where each begins, and its height.
    start = np.empty(width + 2, np.int64)
    height = np.empty(width + 2, np.int64)
    start[0], height[0], steps = 0, 0, 1
    for number in order:
        wide, high = sizes[number]
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
        corners[number] = left, best_top
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

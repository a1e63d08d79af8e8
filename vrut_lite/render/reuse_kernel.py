"""What of the picture before still holds, where it has moved to: each pixel is found there again.

Only a processor draws such pictures. llvmpipe would look up four pixels each at twice the cost.
"""

import numpy as np

from vrut_lite.njit import SUMS_IN_ORDER, njit

# Pixels along a side that a software renderer shades at once.
_BLOCK_LOG2 = 2
# Of depth, as bits: nearer than infinity, farther than anything.
_BEFORE_SKY = np.float32(1e-25)
_BEFORE_SKY_BITS = np.float32(1e-25).view(np.int32)
# Of the four pixels about a place, what is on its surface.
_LEAST_WEIGHT = np.float32(0.4)
_ZERO, _HALF, _ONE, _THREE = (np.float32(number) for number in (0.0, 0.5, 1.0, 3.0))
# Of depth: what a surface may be off, by rounding, by its slope, and at most.
_ROUNDING, _OF_SLOPE, _MOST_OFF = np.float32(2e-4), np.float32(0.1), np.float32(0.01)


@njit(cache=True, nogil=True, fastmath=SUMS_IN_ORDER)
def take_over(  # type: ignore[no-untyped-def]
    front, old_radiance, old_depth, old_from_pixel, brighter, seen_turned, turn, most_apart,
    radiance, depth, first, end,
):  # fmt: skip
    """Write rows from `first` to before `end` of what is taken over, and of its depth.

    `front` (h, w) is the depth of solid surfaces now, `old_radiance` (oh, ow, 4) and `old_depth`
    (oh, ow) all that was drawn before; alpha is the angle of view over which radiance holds, and a
    surface of depth 1 has turned by `seen_turned`. `old_from_pixel` (4, 4) makes of a pixel's
    column, row, depth and 1 those of before, times the last of its rows. Light is `brighter` (3,)
    than then. A pixel that is drawn anew, such as those in `turn`, keeps its depth, which surfaces
    pass; all others get one just before it.
    """
    height, width = front.shape
    old_height, old_width = old_depth.shape
    old, depths = old_radiance.reshape(-1), old_depth.reshape(-1)
    front_bits, depth_bits = front.view(np.int32), depth.view(np.int32)
    across = np.zeros(width + 1, np.float32)
    corner = np.empty(width, np.uint32)
    w0, w1, w2, w3 = np.empty((4, width), np.float32)
    last_x, last_y = np.float32(old_width - 1), np.float32(old_height - 1)
    most_x, most_y = np.float32(old_width - 1.5), np.float32(old_height - 1.5)
    m = old_from_pixel
    stride = np.uint32(old_width)
    for y in range(first, end):
        row, below, above = front[y], front[max(y - 1, 0)], front[min(y + 1, height - 1)]
        for x in range(1, width):
            across[x] = row[x] - row[x - 1]
        fy = np.float32(y)
        x0, y0 = m[0, 1] * fy + m[0, 3], m[1, 1] * fy + m[1, 3]
        z0, n0 = m[2, 1] * fy + m[2, 3], m[3, 1] * fy + m[3, 3]
        for x in range(width):
            d, fx = row[x], np.float32(np.int32(x))
            scale = n0 + m[3, 0] * fx + m[3, 2] * d
            inverse = _ONE / scale
            px = (x0 + m[0, 0] * fx + m[0, 2] * d) * inverse
            py = (y0 + m[1, 0] * fx + m[1, 2] * d) * inverse
            z = (z0 + m[2, 0] * fx + m[2, 2] * d) * inverse
            inside = (scale > _ZERO) & (px > _ZERO) & (py > _ZERO) & (px < last_x) & (py < last_y)
            px = min(max(px, _ZERO), most_x)
            py = min(max(py, _ZERO), most_y)
            ix, iy = np.int32(px), np.int32(py)
            at = np.uint32(iy) * stride + np.uint32(ix)
            sx, sy = px - np.float32(ix), py - np.float32(iy)
            slope_x, other_x = across[x], across[x + 1]
            slope_x = slope_x if abs(slope_x) < abs(other_x) else other_x
            slope_y, other_y = d - below[x], above[x] - d
            slope_y = slope_y if abs(slope_y) < abs(other_y) else other_y
            near = _ROUNDING * z + min(_OF_SLOPE * (abs(slope_x) + abs(slope_y)), _MOST_OFF * z)
            near += _BEFORE_SKY
            near = near if inside else -_ONE
            expected = z - slope_x * sx - slope_y * sy
            # Half of the way to steeper than linear: blurs less where pictures are moved again and
            # again, and moves what is seen less than all of it.
            sx *= _HALF + sx * (_HALF * _THREE - sx)
            sy *= _HALF + sy * (_HALF * _THREE - sy)
            rx, ry = _ONE - sx, _ONE - sy
            d0, d1 = depths[at], depths[at + np.uint32(1)]
            d2, d3 = depths[at + stride], depths[at + stride + np.uint32(1)]
            w0[x] = rx * ry if abs(d0 - expected) <= near else _ZERO
            w1[x] = sx * ry if abs(d1 - expected - slope_x) <= near else _ZERO
            w2[x] = rx * sy if abs(d2 - expected - slope_y) <= near else _ZERO
            w3[x] = sx * sy if abs(d3 - expected - slope_x - slope_y) <= near else _ZERO
            corner[x] = at
        for x in range(width):
            k0, k1, k2, k3 = w0[x], w1[x], w2[x], w3[x]
            total = k0 + k1 + k2 + k3
            share = _ONE / max(total, _LEAST_WEIGHT)
            k0, k1, k2, k3 = k0 * share, k1 * share, k2 * share, k3 * share
            a = 4 * np.intp(corner[x])
            b = a + 4 * old_width
            holds = _mean(old, a + 3, b + 3, k0, k1, k2, k3)
            apart = _apart(holds, seen_turned * row[x]) & most_apart
            # By a lattice in which neighbours are far apart in time.
            has_its_turn = ((x >> _BLOCK_LOG2) + 3 * (y >> _BLOCK_LOG2) - turn) & apart == 0
            out = radiance[y, x]
            if total >= _LEAST_WEIGHT and not has_its_turn:
                for k in range(3):
                    out[k] = brighter[k] * _mean(old, a + k, b + k, k0, k1, k2, k3)
                out[3] = holds
                just_before = front_bits[y, x] + np.int32(1)
                depth_bits[y, x] = just_before if row[x] > _ZERO else _BEFORE_SKY_BITS
            else:
                out[0] = out[1] = out[2] = _ZERO
                out[3] = _ONE
                depth_bits[y, x] = front_bits[y, x]


@njit(inline="always")
def _mean(old, lower, upper, k0, k1, k2, k3):  # type: ignore[no-untyped-def]
    """Of one channel of four pixels, by weights."""
    return (k0 * old[lower] + k1 * old[lower + 4]) + (k2 * old[upper] + k3 * old[upper + 4])


@njit(inline="always")
def _apart(holds, turned):  # type: ignore[no-untyped-def]
    """Pictures between two turns of a pixel, less one, if its view turns by so much in each."""
    if holds >= 16 * turned:
        return 15
    if holds >= 8 * turned:
        return 7
    if holds >= 4 * turned:
        return 3
    return 1 if holds >= 2 * turned else 0

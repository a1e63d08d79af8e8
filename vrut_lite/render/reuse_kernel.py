"""What of the picture before still holds, where it has moved to: each pixel is found there again.

Only a processor draws such pictures. llvmpipe's look-ups of four pixels each take twice as long,
and it runs both sides of every condition, so that nothing can be done for a few pixels alone.
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
def take_over(front, old_radiance, old_depth, old_from_pixel, brighter, seen_turned, turn,
              most_apart, radiance, depth, first, end):  # type: ignore[no-untyped-def]  # fmt: skip
    """Write rows from `first` to before `end` of what is taken over, and of its depth.

    `front` (h, w) is the depth of solid surfaces now, `old_radiance` (oh, ow, 4) and `old_depth`
    (oh, ow) all that was drawn before, `old_from_pixel` (4, 4) makes of a pixel's column, row and
    depth those of before, times the last of its rows. Of radiance, alpha is the angle of view over
    which it holds.
    """
    height, width = front.shape
    old_height, old_width = old_depth.shape
    old, front_bits, depth_bits = old_depth.reshape(-1), front.view(np.int32), depth.view(np.int32)
    old_rgba = old_radiance.reshape(-1)
    across = np.zeros(width + 1, np.float32)
    corner = np.empty(width, np.uint32)
    right, upper = np.empty(width, np.float32), np.empty(width, np.float32)
    weights = np.empty((4, width), np.float32)
    w0, w1, w2, w3 = weights
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
            o0, o1 = old[at], old[at + np.uint32(1)]
            o2, o3 = old[at + stride], old[at + stride + np.uint32(1)]
            w0[x] = rx * ry if abs(o0 - expected) <= near else _ZERO
            w1[x] = sx * ry if abs(o1 - expected - slope_x) <= near else _ZERO
            w2[x] = rx * sy if abs(o2 - expected - slope_y) <= near else _ZERO
            w3[x] = sx * sy if abs(o3 - expected - slope_x - slope_y) <= near else _ZERO
            corner[x] = at
        in_turn = np.int32(3 * (y >> _BLOCK_LOG2) - turn)
        for x in range(width):
            total = w0[x] + w1[x] + w2[x] + w3[x]
            a = np.intp(corner[x]) * 4
            b = a + 4 * np.intp(old_width)
            share = _ONE / max(total, _LEAST_WEIGHT)
            k0, k1, k2, k3 = w0[x] * share, w1[x] * share, w2[x] * share, w3[x] * share
            out = radiance[y, x]
            alpha = (k0 * old_rgba[a + 3] + k1 * old_rgba[a + 7]) + (k2 * old_rgba[b + 3] + k3 * old_rgba[b + 7])
            turned = seen_turned * row[x]
            apart = 15 if alpha >= 16 * turned else 7 if alpha >= 8 * turned else 3 if alpha >= 4 * turned else 1 if alpha >= 2 * turned else 0
            has_turn = ((np.int32(x >> _BLOCK_LOG2) + in_turn) & apart & most_apart) == 0
            if total >= _LEAST_WEIGHT and not has_turn:
                for k in range(3):
                    out[k] = brighter[k] * ((k0 * old_rgba[a + k] + k1 * old_rgba[a + 4 + k]) + (k2 * old_rgba[b + k] + k3 * old_rgba[b + 4 + k]))
                out[3] = alpha
                depth_bits[y, x] = front_bits[y, x] + 1 if row[x] > _ZERO else _BEFORE_SKY_BITS
            else:
                out[0] = out[1] = out[2] = _ZERO
                out[3] = _ONE
                depth_bits[y, x] = front_bits[y, x]

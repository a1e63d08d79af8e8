"""Temporal reprojection: each pixel's surface is sampled in the previous picture.

Only a processor draws such pictures; a shader on llvmpipe would sample at twice the cost.
"""

import numpy as np

from vrut_lite.njit import SUMS_IN_ORDER, njit

# Places are NaN or infinite for a camera that moved too far: comparisons must respect them.
_WITH_NAN = SUMS_IN_ORDER - {"nnan", "ninf"}
# Edge (log2 of pixels) of the blocks that a software renderer shades at once.
_BLOCK_LOG2 = 2
# Depth, and its bits, nearer than infinity and farther than any surface.
_BEFORE_SKY = np.float32(1e-25)
_BEFORE_SKY_BITS = np.float32(1e-25).view(np.int32)
# Least clip w in the previous view; smaller ones are behind its eye.
_BEFORE_EYE = np.float32(1e-9)
# Pixels of a row that are processed together, in loops that the compiler vectorises, and the offset
# of each kind of their numbers.
_CHUNK = 128
_DEPTH, _SLOPE_X, _SLOPE_Y, _NEAR, _EXPECTED, _OLD_X, _OLD_Y, _SHARE_X, _SHARE_Y, _OLD_DEPTHS = (
    kind * _CHUNK for kind in range(10)
)
_WEIGHTS = _OLD_DEPTHS + 4 * _CHUNK
_KINDS = 17
# Least weight of the four pixels about a place that are on its surface.
_LEAST_WEIGHT = np.float32(0.4)
_0, _1, _2, _3, _CHANNELS = (np.uint32(number) for number in range(5))
_NEXT = _1
_ZERO, _HALF, _ONE, _THREE = (np.float32(number) for number in (0.0, 0.5, 1.0, 3.0))
# Depth tolerance: for rounding, for slope, and the largest for slope.
_ROUNDING, _OF_SLOPE, _MOST_OFF = np.float32(2e-4), np.float32(0.1), np.float32(0.01)


@njit(cache=True, nogil=True, fastmath=_WITH_NAN, error_model="numpy")
def take_over(  # type: ignore[no-untyped-def]
    front, old_radiance, old_depth, edges, old_from_pixel, brighter, seen_turned, turn, most_apart,
    radiance, depth, first, end,
):  # fmt: skip
    """Write rows `first` to `end`, excluded, of reprojected radiance and of depth.

    `front` (h, w) is the depth of opaque surfaces, `old_radiance` (oh, ow, 4) and `old_depth`
    (oh, ow) are the previous picture; alpha is the view angle over which radiance is valid,
    negative on a shadow's edge, and a surface of depth 1 has turned by `seen_turned`. Pixels in
    `edges` of `edge_blocks` are shaded. `old_from_pixel` (4, 4) maps a pixel's column, row, depth
    and 1 to the previous ones, homogeneous. Light is `brighter` (3,) times the previous one. A
    shaded pixel, such as those in `turn`, keeps its depth, at which surfaces pass the depth test; a
    reused pixel gets the next nearer depth.
    """
    height, width = front.shape
    old_height, old_width = old_depth.shape
    # Unsigned: numba tests a signed index for one that counts from the end.
    old_row = np.uint32(old_width)
    old, depths = old_radiance.reshape(-1), old_depth.reshape(-1)
    front_bits, depth_bits = front.view(np.int32), depth.view(np.int32)
    chunk, across = np.zeros(_KINDS * _CHUNK, np.float32), np.zeros(width + 1, np.float32)
    shadows_move = edges.size > 0
    for y in range(first, end):
        row, below, above = front[y], front[max(y - 1, 0)], front[min(y + 1, height - 1)]
        for x in range(1, width):
            across[x] = row[x] - row[x - 1]
        for start in range(0, width, _CHUNK):
            count = min(width - start, _CHUNK)
            for i in range(count):
                d, x = row[start + i], start + i
                chunk[_DEPTH + i] = d
                chunk[_SLOPE_X + i] = _smaller(across[x], across[x + 1])
                chunk[_SLOPE_Y + i] = _smaller(d - below[x], above[x] - d)
            _find(chunk, np.float32(start), np.float32(y), old_from_pixel, old_width, old_height)
            for i in range(count):
                at = _index(chunk, i, old_row)
                chunk[_OLD_DEPTHS + i] = depths[at]
                chunk[_OLD_DEPTHS + _CHUNK + i] = depths[at + _NEXT]
                chunk[_OLD_DEPTHS + 2 * _CHUNK + i] = depths[at + old_row]
                chunk[_OLD_DEPTHS + 3 * _CHUNK + i] = depths[at + old_row + _NEXT]
            _weigh(chunk)
            for i in range(count):
                x = start + i
                at = _index(chunk, i, old_row)
                a, b = _CHANNELS * at, _CHANNELS * (at + old_row)
                k0, k1 = chunk[_WEIGHTS + i], chunk[_WEIGHTS + _CHUNK + i]
                k2, k3 = chunk[_WEIGHTS + 2 * _CHUNK + i], chunk[_WEIGHTS + 3 * _CHUNK + i]
                red = _mean(old, a, b, _0, k0, k1, k2, k3)
                green = _mean(old, a, b, _1, k0, k1, k2, k3)
                blue = _mean(old, a, b, _2, k0, k1, k2, k3)
                at_edge = _mean(old, a, b, _3, k0, k1, k2, k3)
                holds = (k0 * abs(old[a + _3]) + k1 * abs(old[a + _CHANNELS + _3])) + (
                    k2 * abs(old[b + _3]) + k3 * abs(old[b + _CHANNELS + _3])
                )
                shadow_moves = (
                    shadows_move and (edges[_block(chunk[_OLD_Y + i]), _block(chunk[_OLD_X + i])])
                )
                apart = _apart(holds, seen_turned * row[x]) & most_apart
                # Turns by a lattice in which neighbours are far apart in time.
                has_its_turn = ((x >> _BLOCK_LOG2) + 3 * (y >> _BLOCK_LOG2) - turn) & apart == 0
                out = radiance[y, x]
                if holds > _ZERO and not has_its_turn and not shadow_moves:
                    out[0], out[1] = brighter[0] * red, brighter[1] * green
                    out[2], out[3] = brighter[2] * blue, holds if at_edge > _ZERO else -holds
                    just_before = front_bits[y, x] + np.int32(1)
                    depth_bits[y, x] = just_before if row[x] > _ZERO else _BEFORE_SKY_BITS
                else:
                    out[0] = out[1] = out[2] = _ZERO
                    out[3] = _ONE
                    depth_bits[y, x] = front_bits[y, x]


@njit(cache=True, nogil=True)
def edge_blocks(radiance, moved):  # type: ignore[no-untyped-def]
    """Blocks of 4 x 4 pixels of a picture (h, w, 4) that a moved sun may shade or light.

    They lie at a shadow's edge or next to one, with a border of one block around the picture; the
    array is empty if no shadow has `moved`.
    """
    if not moved:
        return np.zeros((0, 0), np.bool_)
    height, width = radiance.shape[:2]
    blocks = np.zeros(
        (((height - 1) >> _BLOCK_LOG2) + 3, ((width - 1) >> _BLOCK_LOG2) + 3), np.bool_
    )
    for y in range(height):
        for x in range(width):
            if radiance[y, x, 3] < _ZERO:
                row, column = y >> _BLOCK_LOG2, x >> _BLOCK_LOG2
                blocks[row : row + 3, column : column + 3] = True
    return blocks


@njit(cache=True, nogil=True, fastmath=_WITH_NAN, error_model="numpy")
def _find(chunk, first_x, y, m, old_width, old_height):  # type: ignore[no-untyped-def]
    """Places of a row's pixels in the previous picture, and the expected depth there."""
    last_x, last_y = np.float32(old_width - 1), np.float32(old_height - 1)
    most_x, most_y = np.float32(old_width - 1.5), np.float32(old_height - 1.5)
    xx, xd, x0 = m[0, 0], m[0, 2], m[0, 0] * first_x + m[0, 1] * y + m[0, 3]
    yx, yd, y0 = m[1, 0], m[1, 2], m[1, 0] * first_x + m[1, 1] * y + m[1, 3]
    zx, zd, z0 = m[2, 0], m[2, 2], m[2, 0] * first_x + m[2, 1] * y + m[2, 3]
    nx, nd, n0 = m[3, 0], m[3, 2], m[3, 0] * first_x + m[3, 1] * y + m[3, 3]
    for i in range(_CHUNK):
        d, x = chunk[_DEPTH + i], np.float32(np.int32(i))
        slope_x, slope_y = chunk[_SLOPE_X + i], chunk[_SLOPE_Y + i]
        scale = n0 + nx * x + nd * d
        before_eye = scale > _BEFORE_EYE
        inverse = _ONE / (scale if before_eye else _ONE)
        px = (x0 + xx * x + xd * d) * inverse
        py = (y0 + yx * x + yd * d) * inverse
        z = (z0 + zx * x + zd * d) * inverse
        inside = before_eye & (px > _ZERO) & (py > _ZERO) & (px < last_x) & (py < last_y)
        px, py = (min(px, most_x), min(py, most_y)) if inside else (_ZERO, _ZERO)
        old_x, old_y = np.float32(np.int32(px)), np.float32(np.int32(py))
        share_x, share_y = px - old_x, py - old_y
        near = _ROUNDING * z + min(_OF_SLOPE * (abs(slope_x) + abs(slope_y)), _MOST_OFF * z)
        chunk[_NEAR + i] = near + _BEFORE_SKY if inside else -_ONE
        chunk[_EXPECTED + i] = z - slope_x * share_x - slope_y * share_y
        chunk[_OLD_X + i], chunk[_OLD_Y + i] = old_x, old_y
        chunk[_SHARE_X + i], chunk[_SHARE_Y + i] = share_x, share_y


@njit(cache=True, nogil=True, fastmath=_WITH_NAN, error_model="numpy")
def _weigh(chunk):  # type: ignore[no-untyped-def]
    """Weights of the four pixels about each place: their sum is 1, or 0 at disocclusions."""
    for i in range(_CHUNK):
        slope_x, slope_y = chunk[_SLOPE_X + i], chunk[_SLOPE_Y + i]
        expected, near = chunk[_EXPECTED + i], chunk[_NEAR + i]
        sx, sy = chunk[_SHARE_X + i], chunk[_SHARE_Y + i]
        # Mean of linear and smoothstep weights: less blur than linear ones under repeated
        # reprojection, less displacement than smoothstep.
        sx *= _HALF + sx * (_HALF * _THREE - sx)
        sy *= _HALF + sy * (_HALF * _THREE - sy)
        rx, ry = _ONE - sx, _ONE - sy
        d0, d1 = chunk[_OLD_DEPTHS + i], chunk[_OLD_DEPTHS + _CHUNK + i]
        d2, d3 = chunk[_OLD_DEPTHS + 2 * _CHUNK + i], chunk[_OLD_DEPTHS + 3 * _CHUNK + i]
        k0 = rx * ry if abs(d0 - expected) <= near else _ZERO
        k1 = sx * ry if abs(d1 - expected - slope_x) <= near else _ZERO
        k2 = rx * sy if abs(d2 - expected - slope_y) <= near else _ZERO
        k3 = sx * sy if abs(d3 - expected - slope_x - slope_y) <= near else _ZERO
        total = k0 + k1 + k2 + k3
        share = _ONE / max(total, _LEAST_WEIGHT) if total >= _LEAST_WEIGHT else _ZERO
        chunk[_WEIGHTS + i], chunk[_WEIGHTS + _CHUNK + i] = k0 * share, k1 * share
        chunk[_WEIGHTS + 2 * _CHUNK + i], chunk[_WEIGHTS + 3 * _CHUNK + i] = k2 * share, k3 * share


@njit(inline="always")
def _smaller(one, other):  # type: ignore[no-untyped-def]
    return one if abs(one) < abs(other) else other


@njit(inline="always")
def _block(place):  # type: ignore[no-untyped-def]
    """Row or column of a place in `edges`."""
    return (np.uint32(np.int32(place)) >> np.uint32(_BLOCK_LOG2)) + _NEXT


@njit(inline="always")
def _index(chunk, i, old_row):  # type: ignore[no-untyped-def]
    """Index of the lower left of the four pixels about a place."""
    return np.uint32(np.int32(chunk[_OLD_Y + i])) * old_row + np.uint32(np.int32(chunk[_OLD_X + i]))


@njit(inline="always")
def _mean(old, lower, upper, k, k0, k1, k2, k3):  # type: ignore[no-untyped-def]
    """Weighted mean of one channel of four pixels."""
    return (k0 * old[lower + k] + k1 * old[lower + _CHANNELS + k]) + (
        k2 * old[upper + k] + k3 * old[upper + _CHANNELS + k]
    )


@njit(inline="always")
def _apart(holds, turned):  # type: ignore[no-untyped-def]
    """Pictures between two turns of a pixel, less one, by the angle `turned` in each."""
    if holds >= 16 * turned:
        return 15
    if holds >= 8 * turned:
        return 7
    if holds >= 4 * turned:
        return 3
    return 1 if holds >= 2 * turned else 0

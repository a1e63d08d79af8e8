"""Antialiasing of pictures with one sample per pixel, after the tone map.

Pixels of visible contrast are averaged along the edge if the mean stays within the neighbours'
lumas (Lottes 2009, "FXAA", the short form). That is a tenth of a picture's pixels. Only a processor
draws such pictures; a shader on llvmpipe would sample all pixels, at eight times the cost.
"""

import numpy as np

from vrut_lite.njit import njit

_LONGEST = np.float32(8.0)  # pixels along an edge
# Sums of four lumas: least contrast that is smoothed, and least slope of an edge's direction.
_LEAST_CONTRAST = np.int32(0.03 * 255 * 4)
_LEAST_SHARE, _LEAST_SLOPE = np.float32(0.03), np.float32(4 * 255.0 / 128.0)
_ONE, _TWO, _SIX = np.float32(256.0), np.float32(2.0), np.float32(6.0)
_1, _QUARTER_LOG2, _BYTE_LOG2, _PAIR_LOG2, _LUMA = (np.uint32(n) for n in (1, 2, 8, 16, 24))
_BYTE, _EIGHT = np.uint32(0xFF), np.int32(8)
# Pairs of 16-bit numbers in one of 32 bits.
_PAIR, _ROUND, _HALVES = np.uint32(0x00FF00FF), np.uint32(0x00800080), np.uint32(0x00020002)
# Rows of integers for each pixel at an edge: lumas of its corners and its own, their minimum and
# maximum, and steps along the edge, near and far.
_SW, _SE, _NW, _NE, _OWN, _DARKEST, _BRIGHTEST, _NEAR_X, _NEAR_Y, _FAR_X, _FAR_Y = range(11)
_KINDS = 11


@njit(cache=True, nogil=True, error_model="numpy")
def smooth_edges(toned, display, first, end):  # type: ignore[no-untyped-def]
    """Smooth rows `first` to `end`, excluded, of a picture (h, w) into `display` (h, w, 3), uint8.

    The uint32 of `toned` are red, green, blue and luma from the lowest byte; its row 0 is at the
    bottom, that of `display` at the top.
    """
    height, width = toned.shape
    # Luma sums of the 2 x 2 pixels about each corner of a row's pixels.
    below, above = np.empty(width + 1, np.int32), np.empty(width + 1, np.int32)
    contrast = np.empty(width, np.int32)
    # Pixels at edges: their columns, `edge` rows, and colours at four places.
    at, edge = np.empty(width, np.uint32), np.empty((_KINDS, width), np.int32)
    texel, weight = np.empty((4, width), np.uint32), np.empty((4, width), np.uint32)
    warm, cold = np.empty((4, width), np.uint32), np.empty((4, width), np.uint32)
    _sum_corners(toned[max(first - 1, 0)], toned[first], above)
    for y in range(first, end):
        below, above = above, below
        row, out = toned[y], display[height - 1 - y]
        _sum_corners(row, toned[min(y + 1, height - 1)], above)
        for x in range(width):
            own = np.int32(row[x] >> _LUMA) * np.int32(4)
            contrast[x] = max(
                own, max(max(below[x], below[x + 1]), max(above[x], above[x + 1]))
            ) - min(own, min(min(below[x], below[x + 1]), min(above[x], above[x + 1])))
        for x in range(width):
            _write(out, x, row[x])
        count = 0
        for x in range(width):
            at[count] = x
            count += contrast[x] > _LEAST_CONTRAST
        if count == 0:
            continue
        for i in range(count):
            x = at[i]
            edge[_SW, i], edge[_SE, i] = below[x], below[x + _1]
            edge[_NW, i], edge[_NE, i] = above[x], above[x + _1]
            edge[_OWN, i] = np.int32(row[x] >> _LUMA) * np.int32(4)
        _find_steps(edge, count)
        for k in range(4):
            step = edge[_NEAR_X + k // 2 * 2], edge[_NEAR_Y + k // 2 * 2]
            sign = np.int32(1 - k % 2 * 2)
            _look_up(toned, y, at, count, step, sign, texel, weight, warm[k], cold[k])
        _average(edge, count, warm, cold, texel[0])
        for i in range(count):
            _write(out, at[i], texel[0, i])


@njit(cache=True, nogil=True)
def _sum_corners(lower, upper, sums):  # type: ignore[no-untyped-def]
    """Sums (w + 1,) of the four lumas about each corner between two rows (w,)."""
    width = lower.shape[0]
    for x in range(1, width):
        left = np.int32(lower[x - 1] >> _LUMA) + np.int32(upper[x - 1] >> _LUMA)
        sums[x] = left + np.int32(lower[x] >> _LUMA) + np.int32(upper[x] >> _LUMA)
    sums[0] = 2 * (np.int32(lower[0] >> _LUMA) + np.int32(upper[0] >> _LUMA))
    sums[width] = 2 * (np.int32(lower[-1] >> _LUMA) + np.int32(upper[-1] >> _LUMA))


@njit(inline="always")
def _write(out, x, pixel):  # type: ignore[no-untyped-def]
    out[x, 0] = pixel & _BYTE
    out[x, 1] = (pixel >> _BYTE_LOG2) & _BYTE
    out[x, 2] = (pixel >> _PAIR_LOG2) & _BYTE


@njit(cache=True, nogil=True, error_model="numpy")
def _find_steps(edge, count):  # type: ignore[no-untyped-def]
    """Find the steps along an edge, in 1/256 pixel, and the range of lumas of the mean."""
    for i in range(count):
        sw, se, nw, ne, own = edge[_SW, i], edge[_SE, i], edge[_NW, i], edge[_NE, i], edge[_OWN, i]
        edge[_DARKEST, i] = min(own, min(min(sw, se), min(nw, ne)))
        edge[_BRIGHTEST, i] = max(own, max(max(sw, se), max(nw, ne)))
        right, up = np.float32((nw + ne) - (sw + se)), np.float32((nw + sw) - (ne + se))
        least = max(np.float32(nw + ne + sw + se) * _LEAST_SHARE, _LEAST_SLOPE)
        steepness = min(abs(right), abs(up)) + least
        right = min(max(right / steepness, -_LONGEST), _LONGEST) * _ONE
        up = min(max(up / steepness, -_LONGEST), _LONGEST) * _ONE
        edge[_NEAR_X, i], edge[_NEAR_Y, i] = np.int32(right / _SIX), np.int32(up / _SIX)
        edge[_FAR_X, i], edge[_FAR_Y, i] = np.int32(right / _TWO), np.int32(up / _TWO)


@njit(cache=True, nogil=True, error_model="numpy")
def _look_up(toned, y, at, count, step, sign, texel, weight, warm, cold):  # type: ignore[no-untyped-def]
    """Sample red and blue (`warm`), green and luma (`cold`) at `sign` times a step from pixels.

    Bilinear, with weights in 1/256. `texel` and `weight` (4, w) are overwritten. The compiler
    vectorises all loops but the look-up.
    """
    flat, row = toned.reshape(-1), np.int32(toned.shape[1])
    first, last_x, last_y = np.int32(0), np.int32(toned.shape[1] - 1), np.int32(toned.shape[0] - 1)
    for i in range(count):
        at_x = np.int32(at[i] << _BYTE_LOG2) - sign * step[0][i]
        at_y = np.int32(np.int32(y) << _EIGHT) - sign * step[1][i]
        left, lower = at_x >> _EIGHT, at_y >> _EIGHT
        right, upper = at_x & np.int32(255), at_y & np.int32(255)
        x0, x1 = min(max(left, first), last_x), min(max(left + np.int32(1), first), last_x)
        y0, y1 = min(max(lower, first), last_y), min(max(lower + np.int32(1), first), last_y)
        both = (right * upper + np.int32(128)) >> _EIGHT
        texel[0, i], texel[1, i] = y0 * row + x0, y0 * row + x1
        texel[2, i], texel[3, i] = y1 * row + x0, y1 * row + x1
        weight[0, i], weight[1, i] = np.int32(256) - right - upper + both, right - both
        weight[2, i], weight[3, i] = upper - both, both
    for k in range(4):
        for i in range(count):
            texel[k, i] = flat[texel[k, i]]
    for i in range(count):
        w = c = _ROUND
        for k in range(4):
            w += (texel[k, i] & _PAIR) * weight[k, i]
            c += ((texel[k, i] >> _BYTE_LOG2) & _PAIR) * weight[k, i]
        warm[i], cold[i] = (w >> _BYTE_LOG2) & _PAIR, (c >> _BYTE_LOG2) & _PAIR


@njit(cache=True, nogil=True, error_model="numpy")
def _average(edge, count, warm, cold, pixel):  # type: ignore[no-untyped-def]
    """Average four places, or the two near ones where the far ones leave the edge."""
    for i in range(count):
        near_warm, near_cold = warm[0, i] + warm[1, i], cold[0, i] + cold[1, i]
        far_warm, far_cold = warm[2, i] + warm[3, i], cold[2, i] + cold[3, i]
        # Sums of four, or twice those of two.
        luma = np.int32((near_cold + far_cold) >> _PAIR_LOG2)
        holds = edge[_DARKEST, i] <= luma <= edge[_BRIGHTEST, i]
        w = near_warm + (far_warm if holds else near_warm) + _HALVES
        c = near_cold + (far_cold if holds else near_cold) + _HALVES
        green = (c >> _QUARTER_LOG2) & _BYTE
        pixel[i] = ((w >> _QUARTER_LOG2) & _PAIR) | (green << _BYTE_LOG2)

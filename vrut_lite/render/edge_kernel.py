"""Smooths the steps that one sample a pixel leaves at edges, after the tone map.

Where contrast is seen a picture is averaged along the edge, as far as the mean stays within the
neighbours' lightness (Lottes 2009, "FXAA", the short form). That is a tenth of a picture's pixels.
Only a processor draws such pictures. llvmpipe would look all pixels up, at eight times the cost.
"""

import numpy as np

from vrut_lite.njit import njit

_LONGEST = np.float32(8.0)  # pixels along an edge
# Of sums of four lumas: the least contrast that is smoothed, and the least slope of a direction.
_LEAST_CONTRAST = np.int32(0.03 * 255 * 4)
_LEAST_SHARE, _LEAST_SLOPE = np.float32(0.03), np.float32(4 * 255.0 / 128.0)
_ONE, _TWO, _SIX = np.float32(256.0), np.float32(2.0), np.float32(6.0)
_LUMA, _BYTE = np.uint32(24), np.uint32(0xFF)
# Four numbers of 16 bits each in one of 64.
_PAIR, _BYTES = np.uint64(0x00FF00FF), np.uint64(0x00FF00FF00FF00FF)
_ROUND, _HALVES = np.uint64(0x0080008000800080), np.uint64(0x0002000200020002)
_BYTE_OF_SUM = np.uint64(0xFF)


@njit(cache=True, nogil=True)
def smooth_edges(toned, display, first, end):  # type: ignore[no-untyped-def]
    """Write rows from `first` to before `end` of a picture (h, w), whose uint32 are red, green,
    blue and luma from the lowest byte on, into one for display (h, w, 3), uint8.

    Row 0 of what comes is at the bottom, of what is written at the top.
    """
    height, width = toned.shape
    # Of the 2 x 2 pixels about each corner of a row's pixels.
    below, above = np.empty(width + 1, np.int32), np.empty(width + 1, np.int32)
    contrast = np.empty(width, np.int32)
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
            if contrast[x] > _LEAST_CONTRAST:
                corners = below[x], below[x + 1], above[x], above[x + 1]
                out[x, 0], out[x, 1], out[x, 2] = _smoothed(toned, x, y, corners)
            else:
                out[x, 0] = row[x] & _BYTE
                out[x, 1] = (row[x] >> np.uint32(8)) & _BYTE
                out[x, 2] = (row[x] >> np.uint32(16)) & _BYTE


@njit(cache=True, nogil=True)
def _sum_corners(lower, upper, sums):  # type: ignore[no-untyped-def]
    """Sums (w + 1,) of the four lumas about each corner between two rows (w,)."""
    width = lower.shape[0]
    for x in range(1, width):
        left = np.int32(lower[x - 1] >> _LUMA) + np.int32(upper[x - 1] >> _LUMA)
        sums[x] = left + np.int32(lower[x] >> _LUMA) + np.int32(upper[x] >> _LUMA)
    sums[0] = 2 * (np.int32(lower[0] >> _LUMA) + np.int32(upper[0] >> _LUMA))
    sums[width] = 2 * (np.int32(lower[-1] >> _LUMA) + np.int32(upper[-1] >> _LUMA))


@njit(cache=True, nogil=True)
def _smoothed(toned, x, y, corners):  # type: ignore[no-untyped-def]
    """Red, green and blue of a pixel at an edge; `corners` are those of below, then above it."""
    sw, se, nw, ne = corners
    own = np.int32(toned[y, x] >> _LUMA) * np.int32(4)
    right, up = np.float32((nw + ne) - (sw + se)), np.float32((nw + sw) - (ne + se))
    least = max(np.float32(nw + ne + sw + se) * _LEAST_SHARE, _LEAST_SLOPE)
    steepness = min(abs(right), abs(up)) + least
    right = min(max(right / steepness, -_LONGEST), _LONGEST) * _ONE
    up = min(max(up / steepness, -_LONGEST), _LONGEST) * _ONE
    near_x, near_y = np.int32(right / _SIX), np.int32(up / _SIX)
    far_x, far_y = np.int32(right / _TWO), np.int32(up / _TWO)
    at_x, at_y = np.int32(x << 8), np.int32(y << 8)
    near = _at(toned, at_x - near_x, at_y - near_y) + _at(toned, at_x + near_x, at_y + near_y)
    far = _at(toned, at_x - far_x, at_y - far_y) + _at(toned, at_x + far_x, at_y + far_y)
    # Sums of four, or twice those of two.
    luma = np.int32((near + far) >> np.uint64(48))
    darkest = min(own, min(min(sw, se), min(nw, ne)))
    brightest = max(own, max(max(sw, se), max(nw, ne)))
    total = near + far if darkest <= luma <= brightest else near + near
    total += _HALVES
    return (
        np.uint8((total >> np.uint64(2)) & _BYTE_OF_SUM),
        np.uint8((total >> np.uint64(34)) & _BYTE_OF_SUM),
        np.uint8((total >> np.uint64(18)) & _BYTE_OF_SUM),
    )


@njit(cache=True, nogil=True)
def _at(toned, x, y):  # type: ignore[no-untyped-def]
    """Red, blue, green and luma in four parts of 16 bits, at a place in parts of 256 of a pixel.

    Linear between the middles of pixels, by shares in parts of 256.
    """
    height, width = toned.shape
    left, lower = x >> 8, y >> 8
    right, upper = x & 255, y & 255
    x0, x1 = min(max(left, 0), width - 1), min(max(left + 1, 0), width - 1)
    y0, y1 = min(max(lower, 0), height - 1), min(max(lower + 1, 0), height - 1)
    both = (right * upper + 128) >> 8
    # Counted without a sign: numba takes an index below zero for one from the end, and asks.
    x0, x1, y0, y1 = np.uint32(x0), np.uint32(x1), np.uint32(y0), np.uint32(y1)
    total = _spread(toned[y0, x0]) * np.uint64(256 - right - upper + both)
    total += _spread(toned[y0, x1]) * np.uint64(right - both)
    total += _spread(toned[y1, x0]) * np.uint64(upper - both)
    total += _spread(toned[y1, x1]) * np.uint64(both)
    return ((total + _ROUND) >> np.uint64(8)) & _BYTES


@njit(cache=True, nogil=True)
def _spread(pixel):  # type: ignore[no-untyped-def]
    """The four bytes of a pixel in 16 bits each: red, blue, green, luma."""
    wide = np.uint64(pixel)
    return (wide & _PAIR) | (((wide >> np.uint64(8)) & _PAIR) << np.uint64(32))

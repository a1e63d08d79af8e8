"""Smooths the steps that one sample a pixel leaves at edges, after the tone map.

Where contrast is seen a picture is averaged along the edge, as far as the mean stays within the
neighbours' lightness (Lottes 2009, "FXAA", the short form). That is a tenth of a picture's pixels.
Only a processor draws such pictures. llvmpipe would look all pixels up, at eight times the cost.
"""

import numpy as np

from vrut_lite.njit import njit

_LONGEST = 8.0  # pixels along an edge
# Of sums of four lumas: the least contrast that is smoothed, and the least slope of a direction.
_LEAST_CONTRAST = np.int32(0.03 * 255 * 4)
_LEAST_SLOPE = 4 * 255.0 / 128.0
_LUMA, _BYTE = np.uint32(24), np.uint32(0xFF)


@njit(cache=True, nogil=True)
def smooth_edges(toned, display):  # type: ignore[no-untyped-def]
    """Write a picture for display (h, w, 3), uint8, of one (h, w) whose uint32 are red, green, blue
    and luma, from the lowest byte on.

    Row 0 of what comes is at the bottom, of what is written at the top.
    """
    height, width = toned.shape
    # Of the 2 x 2 pixels about each corner of a row's pixels.
    below, above = np.empty(width + 1, np.int32), np.empty(width + 1, np.int32)
    contrast = np.empty(width, np.int32)
    _sum_corners(toned[0], toned[0], above)
    for y in range(height):
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
    right, up = float((nw + ne) - (sw + se)), float((nw + sw) - (ne + se))
    least = max((nw + ne + sw + se) * 0.03, _LEAST_SLOPE)
    steepness = min(abs(right), abs(up)) + least
    right = min(max(right / steepness, -_LONGEST), _LONGEST)
    up = min(max(up / steepness, -_LONGEST), _LONGEST)
    one = _at(toned, x - right / 6.0, y - up / 6.0)
    other = _at(toned, x + right / 6.0, y + up / 6.0)
    first = _at(toned, x - right / 2.0, y - up / 2.0)
    last = _at(toned, x + right / 2.0, y + up / 2.0)
    luma = one[3] + other[3] + first[3] + last[3]
    darkest, brightest = (
        min(own, min(min(sw, se), min(nw, ne))),
        max(own, max(max(sw, se), max(nw, ne))),
    )
    far = 0.25 if darkest <= luma <= brightest else 0.0
    near = 0.5 - far
    return (
        np.uint8(near * (one[0] + other[0]) + far * (first[0] + last[0]) + 0.5),
        np.uint8(near * (one[1] + other[1]) + far * (first[1] + last[1]) + 0.5),
        np.uint8(near * (one[2] + other[2]) + far * (first[2] + last[2]) + 0.5),
    )


@njit(cache=True, nogil=True)
def _at(toned, x, y):  # type: ignore[no-untyped-def]
    """Red, green, blue and luma at a place, linear between the middles of pixels."""
    height, width = toned.shape
    left, lower = int(np.floor(x)), int(np.floor(y))
    right, upper = x - left, y - lower
    x0, x1 = min(max(left, 0), width - 1), min(max(left + 1, 0), width - 1)
    y0, y1 = min(max(lower, 0), height - 1), min(max(lower + 1, 0), height - 1)
    a, b, c, d = toned[y0, x0], toned[y0, x1], toned[y1, x0], toned[y1, x1]
    of_a, of_b = (1.0 - right) * (1.0 - upper), right * (1.0 - upper)
    of_c, of_d = (1.0 - right) * upper, right * upper
    return (
        _mean(a, b, c, d, of_a, of_b, of_c, of_d, np.uint32(0)),
        _mean(a, b, c, d, of_a, of_b, of_c, of_d, np.uint32(8)),
        _mean(a, b, c, d, of_a, of_b, of_c, of_d, np.uint32(16)),
        _mean(a, b, c, d, of_a, of_b, of_c, of_d, _LUMA),
    )


@njit(cache=True, nogil=True)
def _mean(a, b, c, d, of_a, of_b, of_c, of_d, bits):  # type: ignore[no-untyped-def]
    """One channel of four pixels, by their shares."""
    return (
        of_a * np.int32((a >> bits) & _BYTE)
        + of_b * np.int32((b >> bits) & _BYTE)
        + of_c * np.int32((c >> bits) & _BYTE)
        + of_d * np.int32((d >> bits) & _BYTE)
    )

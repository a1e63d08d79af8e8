"""The tone map of moving pictures, as in `passes/tone_pass.py`: each channel by a table.

Only a processor draws such pictures. A shader on llvmpipe takes three times as long, mostly for
texture look-ups and logarithms.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMINANCE_WEIGHTS
from vrut_lite.messages.picture import SetExposure, ToneMap
from vrut_lite.njit import SUMS_IN_ORDER, njit
from vrut_lite.pictures import display, tone_map
from vrut_lite.render.passes.tone_pass import from_radiance, outset
from vrut_lite.render.software.row_threads import run_in_halves

# Entries of a table per octave, as bits of a float's fraction. Neighbours differ by at most 0.3 of
# 255.
_FRACTION_BITS = 8
_DROPPED = 23 - _FRACTION_BITS
_DARKEST_LOG2, _BRIGHTEST_LOG2 = -14, 5
_FIRST = (127 + _DARKEST_LOG2) << _FRACTION_BITS
# Dither is made in whole tiles: it takes 20 ms, and moving pictures change their size.
_TILE_PX = 1024
_CHUNK = 256  # pixels
_ZERO, _HALF, _ONE, _BYTE = (np.float32(number) for number in (0.0, 0.5, 1.0, 255.0))


@lru_cache(maxsize=4)
def _table(curve: ToneMap) -> NDArray[np.float32]:
    """Encoded values (n,) of one channel by the leading bits of a float."""
    count = (_BRIGHTEST_LOG2 - _DARKEST_LOG2) << _FRACTION_BITS
    bits = ((_FIRST + np.arange(count)) << _DROPPED) + (1 << (_DROPPED - 1))
    values = bits.astype(np.int32).view(np.float32).astype(float)
    # All darker values use this entry.
    values[0] = 0.0
    # Grey: neither of AgX's matrices changes it.
    encoded = tone_map.tone_mapped(np.repeat(values[:, None], 3, axis=1), curve)[:, 1]
    return np.asarray(encoded, np.float32)


@lru_cache(maxsize=2)
def _dither(tiles_down: int, tiles_across: int) -> NDArray[np.float32]:
    """Dither and one half, added before truncation to bytes, for pictures of so many tiles."""
    noise = display.dither(tiles_down * _TILE_PX, tiles_across * _TILE_PX)
    return (noise + 0.5).astype(np.float32)


def tone_mapped(
    radiance: NDArray[np.float32], ev100: float, wish: SetExposure
) -> NDArray[np.uint32]:
    """Bytes (h, w) for `smooth_edges` of radiance (h, w, 4), row 0 at the bottom.

    The eye's look of nights is not supported: it depends on a pixel's neighbours.
    """
    height, width = radiance.shape[:2]
    toned = np.empty((height, width), np.uint32)
    matrices = (from_radiance(ev100, wish), outset(wish.tone_map), np.array(LUMINANCE_WEIGHTS))
    run_in_halves(
        tone,
        height,
        radiance,
        _dither(-(-height // _TILE_PX), -(-width // _TILE_PX)),
        _table(wish.tone_map),
        *(matrix.astype(np.float32) for matrix in matrices),
        toned,
    )
    return toned


@njit(cache=True, nogil=True, fastmath=SUMS_IN_ORDER)
def tone(radiance, dither, table, inset, outset, weights, toned, first, end):  # type: ignore[no-untyped-def]
    """Write rows `first` to `end`, excluded, of bytes (h, w): red, green, blue, luma.

    `inset` (3, 3) maps `radiance` (h, w, 4) to the table's argument, `outset` (3, 3) its values to
    a colour, `weights` (3,) a colour to luma. `dither` may be larger than the picture.
    """
    last = np.int32(len(table) - 1)
    # Pixels are processed in chunks: the compiler vectorises all loops but the look-up.
    place, encoded = np.empty((3, _CHUNK), np.uint32), np.empty((3, _CHUNK), np.float32)
    for y in range(first, end):
        for start in range(0, toned.shape[1], _CHUNK):
            stop = min(start + _CHUNK, toned.shape[1])
            row, out, noise = radiance[y, start:stop], toned[y, start:stop], dither[y, start:stop]
            for x in range(len(out)):
                r, g, b = row[x, 0], row[x, 1], row[x, 2]
                for k in range(3):
                    value = inset[k, 0] * r + inset[k, 1] * g + inset[k, 2] * b
                    bits = np.float32(max(value, _ZERO)).view(np.int32)
                    place[k, x] = min(max((bits >> _DROPPED) - _FIRST, 0), last)
            for k in range(3):
                for x in range(len(out)):
                    encoded[k, x] = table[place[k, x]]
            for x in range(len(out)):
                u, v, w = encoded[0, x], encoded[1, x], encoded[2, x]
                red = _within_one(outset[0, 0] * u + outset[0, 1] * v + outset[0, 2] * w)
                green = _within_one(outset[1, 0] * u + outset[1, 1] * v + outset[1, 2] * w)
                blue = _within_one(outset[2, 0] * u + outset[2, 1] * v + outset[2, 2] * w)
                luma = weights[0] * red + weights[1] * green + weights[2] * blue
                out[x] = (
                    _byte(red, noise[x])
                    | _byte(green, noise[x]) << np.uint32(8)
                    | _byte(blue, noise[x]) << np.uint32(16)
                    | _byte(luma, _HALF) << np.uint32(24)
                )


@njit(inline="always")
def _within_one(number):  # type: ignore[no-untyped-def]
    return min(max(number, _ZERO), _ONE)


@njit(inline="always")
def _byte(number, added):  # type: ignore[no-untyped-def]
    return np.uint32(np.int32(min(max(_BYTE * number + added, _ZERO), _BYTE)))

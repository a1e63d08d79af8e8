"""The fast cube map in half precision or tone-mapped bytes.

Rows are computed a few at a time into a buffer that stays in the processor's cache, and
converted there: the float32 map is never in memory as a whole.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dynamic_skylight.hosek_wilkie.cube_rows import (
    BOTTOM,
    COMPILE,
    LEAST_EXPONENT,
    TOP,
    SkyRows,
    checked_cube,
    exp2m1,
    side_faces,
)
from vrut_lite.njit import njit
from vrut_lite.numeric_types import Float32Array

Convert = Callable[[Float32Array, NDArray[Any]], None]

LARGEST_HALF = np.float32(65504.0)
_ROWS_AT_ONCE = 8
_HALF_ONE, _LARGEST_BYTE = np.float32(0.5), np.float32(255.0)
# In bits of a float32: half an ulp of a half less one, the change of the exponent's bias, and the
# smallest float whose half is a normal number.
_ROUND, _REBIAS, _NORMAL = np.int32(0x0FFF), np.int32(112 << 23), np.int32(113 << 23)
_BITS_OF_HALF_ONE, _SHIFT, _ONE_BIT = np.int32(126 << 23), np.int32(13), np.int32(1)


@njit(**COMPILE)
def _to_half(source, out):  # type: ignore[no-untyped-def]
    """Bits (uint16) of the nearest half, ties to even, of values that are not negative."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            x = min(source[i, j], LARGEST_HALF)
            bits = np.float32(x).view(np.int32)
            normal = (bits - _REBIAS + _ROUND + ((bits >> _SHIFT) & _ONE_BIT)) >> _SHIFT
            # 0.5 has the ulp of subnormal halves, so the sum rounds correctly.
            subnormal = np.float32(x + _HALF_ONE).view(np.int32) - _BITS_OF_HALF_ONE
            out[i, j] = np.uint16(normal if bits >= _NORMAL else subnormal)


@njit(**COMPILE)
def _to_byte(source, out):  # type: ignore[no-untyped-def]
    """255 (1 - 2^-x), rounded."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            tone = -_LARGEST_BYTE * exp2m1(max(-source[i, j], LEAST_EXPONENT))
            out[i, j] = np.uint8(np.int32(tone + _HALF_ONE))


def fill_half(
    sky: SkyRows, faces: tuple[int, ...], out: NDArray[np.float16] | None = None
) -> NDArray[np.float16]:
    """The faces (6, n, n, 3) in half precision, 0 below the horizon."""
    cube = checked_cube(sky.size, np.float16, out, faces)
    _fill(sky, faces, cube.view(np.uint16), _to_half)
    return cube


def fill_bytes(
    sky: SkyRows, faces: tuple[int, ...], out: NDArray[np.uint8] | None = None
) -> NDArray[np.uint8]:
    """The faces (6, n, n, 3) as 255 (1 - 2^-L), 0 below the horizon."""
    cube = checked_cube(sky.size, np.uint8, out, faces)
    _fill(sky, faces, cube, _to_byte)
    return cube


def _fill(sky: SkyRows, faces: tuple[int, ...], cube: NDArray[Any], convert: Convert) -> None:
    size = sky.size
    rows = cube.reshape(6, size, 3 * size)
    sides = side_faces(faces)
    places = np.arange(len(sides), dtype=np.intp)
    buffer = np.empty((max(len(sides), 1), _ROWS_AT_ONCE, 3 * size), np.float32)
    for first, last in _blocks(size // 2 if len(sides) else 0):
        sky.sides(buffer, places, sides, first, last, first)
        for place, face in enumerate(sides):
            convert(buffer[place, : last - first], rows[face, first:last])
    rows[sides, size // 2 :] = 0
    for first, last in _blocks(size if TOP in faces else 0):
        sky.top(buffer[0], first, last, first)
        convert(buffer[0, : last - first], rows[TOP, first:last])
    if BOTTOM in faces:
        rows[BOTTOM] = 0


def _blocks(count: int) -> Iterator[tuple[int, int]]:
    for first in range(0, count, _ROWS_AT_ONCE):
        yield first, min(first + _ROWS_AT_ONCE, count)

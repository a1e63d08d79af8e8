"""Reads blocks of plain OBJ text, compiled: vertices, and faces as fans of triangles.

A line that is not plain (words for numbers, rows of differing length, indices out of range) ends
the reading: obj_file.py then reads the block word by word and names the fault. Importing this
module imports numba.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.njit import njit

# Columns of rows that are kept, and the most corners of a face; others are not plain.
_MOST_COLUMNS = 8
_MOST_CORNERS = 64
_POSITIONS, _UV, _NORMALS = 0, 1, 2
_SPACE, _NEWLINE, _SLASH, _MINUS, _PLUS, _DOT, _ZERO, _NINE = 32, 10, 47, 45, 43, 46, 48, 57
_V, _F, _T, _N = 118, 102, 116, 110
_E_SMALL, _E_LARGE = 101, 69
# A product of a number of 15 digits and a power up to 22 is exact but for one rounding.
_TENS = 10.0 ** np.arange(23)
_MOST_DIGITS = 18
_MOST_EXPONENT = 300
_PLAIN, _ODD = 0, 1


class PlainBlock(NamedTuple):
    """Rows of v, vt and vn (n, columns); triangles' corners (F, 3, 3), counted from 1, 0 for none.

    In triangles after a polygon's first one the number of the first corner's vertex is negative.

    `lines` (E, 3) are the other lines: where each begins and ends, and how many triangles come
    before it.
    """

    rows: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
    corners: NDArray[np.int32]
    lines: NDArray[np.int64]


def read_plain_block(block: bytes, counts: tuple[int, int, int]) -> PlainBlock | None:
    """The content of whole lines, or None if they are not plain.

    `counts` are the rows of v, vt and vn before the block, which negative indices count back from.
    """
    text = np.frombuffer(block, np.uint8)
    sizes, columns = np.zeros(5, np.int64), np.zeros(3, np.int64)
    if _measure(text, sizes, columns) != _PLAIN:
        return None
    numbers = tuple(np.empty((sizes[kind], columns[kind])) for kind in range(3))
    corners = np.empty((sizes[3], 3, 3), np.int32)
    lines = np.empty((sizes[4], 3), np.int64)
    before = np.array(counts, np.int64)
    if _fill(text, before, numbers[0], numbers[1], numbers[2], corners, lines) != _PLAIN:
        return None
    return PlainBlock((numbers[0], numbers[1], numbers[2]), corners, lines)


@njit(cache=True, nogil=True)
def _is_space(byte: int) -> bool:
    return byte == _SPACE or byte == 9 or 11 <= byte <= 13


@njit(cache=True, nogil=True)
def _line_end(text: NDArray[np.uint8], at: int) -> int:
    while at < text.size and text[at] != _NEWLINE:
        at += 1
    return at


@njit(cache=True, nogil=True)
def _skip_spaces(text: NDArray[np.uint8], at: int, end: int) -> int:
    while at < end and _is_space(text[at]):
        at += 1
    return at


@njit(cache=True, nogil=True)
def _kind(text: NDArray[np.uint8], at: int, end: int) -> tuple[int, int]:
    """The kind of a line (0 to 2: v, vt, vn; 3: f; 4: another) and where its values begin."""
    if at + 1 < end and text[at + 1] == _SPACE:
        if text[at] == _V:
            return _POSITIONS, at + 2
        if text[at] == _F:
            return 3, at + 2
    if at + 2 < end and text[at] == _V and text[at + 2] == _SPACE:
        if text[at + 1] == _T:
            return _UV, at + 3
        if text[at + 1] == _N:
            return _NORMALS, at + 3
    return 4, at


@njit(cache=True, nogil=True)
def _words(text: NDArray[np.uint8], at: int, end: int) -> int:
    words = 0
    while True:
        at = _skip_spaces(text, at, end)
        if at == end:
            return words
        words += 1
        while at < end and not _is_space(text[at]):
            at += 1


@njit(cache=True, nogil=True)
def _line(text: NDArray[np.uint8], at: int) -> tuple[int, int, int, int]:
    """Where a line's first word begins, where its values do, where it ends, and its kind."""
    end = _line_end(text, at)
    first = _skip_spaces(text, at, end)
    kind, values = _kind(text, first, end)
    return first, values, end, kind


@njit(cache=True, nogil=True)
def _measure(text: NDArray[np.uint8], sizes: NDArray[np.int64], columns: NDArray[np.int64]) -> int:
    """Fill in the rows of each kind, triangles and other lines, and the columns of rows."""
    at = 0
    while at < text.size:
        first, values, end, kind = _line(text, at)
        at = end + 1
        if first == end:
            continue
        if kind == 4:
            sizes[4] += 1
            continue
        words = _words(text, values, end)
        if kind == 3:
            if words > _MOST_CORNERS:
                return _ODD
            # Points and lines of one or two corners are no triangles.
            sizes[3] += max(words - 2, 0)
            continue
        least = 2 if kind == _UV else 3
        if words < least or words > _MOST_COLUMNS or (sizes[kind] and words != columns[kind]):
            return _ODD
        columns[kind] = words
        sizes[kind] += 1
    return _PLAIN


@njit(cache=True, nogil=True)
def _fill(
    text: NDArray[np.uint8],
    before: NDArray[np.int64],
    positions: NDArray[np.float64],
    uv: NDArray[np.float64],
    normals: NDArray[np.float64],
    corners: NDArray[np.int32],
    lines: NDArray[np.int64],
) -> int:
    """Fill in the arrays of a block that has been measured; `before` ends as the rows after it."""
    number = np.zeros(3, np.int64)
    polygon = np.zeros((_MOST_CORNERS, 3), np.int64)
    triangles, others, at = 0, 0, 0
    while at < text.size:
        first, values, end, kind = _line(text, at)
        at = end + 1
        if first == end:
            continue
        if kind == 4:
            lines[others, 0], lines[others, 1], lines[others, 2] = first, end, triangles
            others += 1
            continue
        if kind == 3:
            found = _face(text, values, end, before, polygon)
            if found < 0:
                return _ODD
            for corner in range(1, found - 1):
                for part in range(3):
                    corners[triangles, 0, part] = polygon[0, part]
                    if part == 0 and corner > 1:
                        corners[triangles, 0, part] = -polygon[0, part]
                    corners[triangles, 1, part] = polygon[corner, part]
                    corners[triangles, 2, part] = polygon[corner + 1, part]
                triangles += 1
            continue
        rows = positions if kind == _POSITIONS else uv if kind == _UV else normals
        where = values
        for column in range(rows.shape[1]):
            where = _skip_spaces(text, where, end)
            where, value = _number(text, where, end)
            if where < 0:
                return _ODD
            rows[number[kind], column] = value
        number[kind] += 1
        before[kind] += 1
    return _PLAIN


@njit(cache=True, nogil=True)
def _face(
    text: NDArray[np.uint8],
    at: int,
    end: int,
    counts: NDArray[np.int64],
    polygon: NDArray[np.int64],
) -> int:
    """Fill in the corners of a face, numbers of v, vt and vn; how many, or -1 if not plain."""
    found = 0
    while True:
        at = _skip_spaces(text, at, end)
        if at == end:
            return found
        for part in range(3):
            polygon[found, part] = 0
        part = 0
        while at < end and not _is_space(text[at]):
            if text[at] == _SLASH:
                part += 1
                at += 1
                if part > 2:
                    return -1
                continue
            negative = text[at] == _MINUS
            at += 1 if negative else 0
            value, digits = 0, 0
            while at < end and _ZERO <= text[at] <= _NINE:
                value = 10 * value + (text[at] - _ZERO)
                digits += 1
                at += 1
            ended = at == end or text[at] == _SLASH or _is_space(text[at])
            if digits == 0 or digits > 9 or not ended:
                return -1
            if negative:
                value = counts[part] + 1 - value
            if value < 1:
                return -1
            polygon[found, part] = value
        if polygon[found, 0] < 1:
            return -1
        found += 1


@njit(cache=True, nogil=True)
def _number(text: NDArray[np.uint8], at: int, end: int) -> tuple[int, float]:
    """The end of a decimal number and its value; the end is -1 for another text.

    Exact up to 15 digits and 22 decimals, else within a few units in the last place.
    """
    if at == end:
        return -1, 0.0
    negative = text[at] == _MINUS
    if negative or text[at] == _PLUS:
        at += 1
    mantissa, digits, exponent, seen, point = 0, 0, 0, 0, False
    while at < end:
        byte = text[at]
        if _ZERO <= byte <= _NINE:
            seen += 1
            if digits < _MOST_DIGITS:
                mantissa = 10 * mantissa + (byte - _ZERO)
                digits += 1 if mantissa else 0
                exponent -= 1 if point else 0
            else:
                exponent += 0 if point else 1
        elif byte == _DOT and not point:
            point = True
        else:
            break
        at += 1
    if seen == 0:
        return -1, 0.0
    if at < end and (text[at] == _E_SMALL or text[at] == _E_LARGE):
        at += 1
        below = at < end and text[at] == _MINUS
        if at < end and (text[at] == _MINUS or text[at] == _PLUS):
            at += 1
        power, seen = 0, 0
        while at < end and _ZERO <= text[at] <= _NINE:
            power = min(10 * power + (text[at] - _ZERO), 10_000)
            seen += 1
            at += 1
        if seen == 0:
            return -1, 0.0
        exponent += -power if below else power
    if at < end and not _is_space(text[at]):
        return -1, 0.0
    value = float(mantissa)
    if exponent < -_MOST_EXPONENT or exponent > _MOST_EXPONENT:
        return -1, 0.0
    while exponent < 0:
        step = min(-exponent, 22)
        value /= _TENS[step]
        exponent += step
    while exponent > 0:
        step = min(exponent, 22)
        value *= _TENS[step]
        exponent -= step
    return at, -value if negative else value

"""The Hosek-Wilkie cube map in single precision, half precision or tone-mapped bytes.

A row of texels shares its zenith's part with the rows of the other side faces or, on the top, with
the row at the same distance from the middle; that part is even, so half of it is computed. Rows of
large maps are computed in blocks of texels, each from one piece of a table, those of small maps
texel by texel. `sky_tables` describes the tables, `texel_lanes` the look-ups.
"""

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dynamic_skylight.hosek_wilkie.sky_tables import (
    COMPILE,
    GLOW_SCALE,
    ZENITH_SCALE,
    glow_piece,
    sky_tables,
    zenith_piece,
)
from dynamic_skylight.hosek_wilkie.texel_lanes import (
    BLOCK,
    encode_numbers,
    light_of_block,
    light_of_texel,
    place_block,
    zenith_of_blocks,
    zenith_of_texel,
)
from vrut_lite.arguments import as_count, check_output, check_type, shown
from vrut_lite.geometry.cube_map import FACE_NORMALS, FACE_S_AXES, FACE_T_AXES, FACES, texel_centres
from vrut_lite.njit import njit
from vrut_lite.numeric_types import Float32Array, FloatArray

SIDES = (0, 1, 4, 5)
TOP, BOTTOM = 2, 3
# Six faces of this size, in single precision, take 4.8 GB.
LARGEST_SIZE = 8192
_NAME_OF_FACES = f"faces, numbered in the order {', '.join(FACES)},"
# Axes of each face: along its rows, outwards, and across its rows (up, for the sides).
_AXES = np.stack([FACE_S_AXES, FACE_NORMALS, -FACE_T_AXES], axis=1)
_AXES[TOP, 2] = FACE_T_AXES[TOP]
_ONE = np.float32(1.0)
_BLOCK, _PAIR = np.uintp(BLOCK), np.uintp(2 * BLOCK)
# Least edge of a map whose blocks lie within a piece of the tables each.
_BLOCKS_FROM = 256


class _Spaces(NamedTuple):
    """Numbers of the row in work, as many as the texels of whole blocks."""

    inverse: Float32Array  # 1 / length of the directions
    root: Float32Array  # of the cosines of their zenith angles
    factors: Float32Array  # Z: three rows of a large map, or four numbers a texel
    of_centres: Float32Array  # `inverse` of the blocks' centres
    piece: NDArray[np.int32]  # of a table: its first number, where it begins, and
    start: Float32Array
    sign: Float32Array  # -1 where it lies about the point opposite the sun
    place: Float32Array  # in a piece
    light: Float32Array  # three numbers a texel
    encoded: NDArray[Any]


@njit(**COMPILE)
def _heights(up, rest, a, count, inverse, root):  # type: ignore[no-untyped-def]
    """1 / length of `count` directions (a, ., .), and the roots of their cosines.

    `up` is their height, `rest` the square of all but their first number.
    """
    for j in range(count):
        inverse[j] = _ONE / math.sqrt(rest + a[j] * a[j])
    for j in range(count):
        root[j] = math.sqrt(up * inverse[j])


@njit(**COMPILE)
def _zenith_pieces(root, count, piece, start):  # type: ignore[no-untyped-def]
    for j in range(count):
        piece[j], start[j] = zenith_piece(root[j])


@njit(**COMPILE)
def _zenith_row(up, rest, a, centres, table, at):  # type: ignore[no-untyped-def]
    """The zenith's part of a row: it is even in a, and computed for half of it."""
    n, stride = np.uintp(a.size), np.uintp(at.root.size)
    if n < _BLOCKS_FROM:
        _heights(up, rest, a, n, at.inverse, at.root)
        half = (n + np.uintp(1)) // np.uintp(2)
        _zenith_pieces(at.root, half, at.piece, at.start)
        for j in range(half):
            x = at.root[j] * ZENITH_SCALE + at.start[j]
            twin = n - np.uintp(1) - j
            zenith_of_texel(at.factors, table, np.uintp(at.piece[j]), x, j, twin)
        return
    # Half the row's texels, in whole blocks.
    blocks = (n + _PAIR - np.uintp(1)) // _PAIR
    _heights(up, rest, centres, centres.size, at.of_centres, at.root)
    _zenith_pieces(at.root, blocks, at.piece, at.start)
    _heights(up, rest, a, blocks * _BLOCK, at.inverse, at.root)
    for block in range(blocks):
        texel = block * _BLOCK
        zenith_of_blocks(
            at.factors, stride, table, at.root, at.inverse,
            np.uintp(at.piece[block]), at.start[block], texel, n - _BLOCK - texel,
        )  # fmt: skip


@njit(**COMPILE)
def _glow_pieces(inverse, centres, height, sun, piece, start, sign):  # type: ignore[no-untyped-def]
    for j in range(centres.size):
        q = inverse[j]
        piece[j], start[j], _, sign[j] = glow_piece(centres[j] * q, q, height * q, sun)


@njit(**COMPILE)
def _glow_places(inverse, a, height, sun, piece, place):  # type: ignore[no-untyped-def]
    for j in range(a.size):
        q = inverse[j]
        piece[j], start, chord, _ = glow_piece(a[j] * q, q, height * q, sun)
        place[j] = chord * GLOW_SCALE + start


@njit(**COMPILE)
def _light_texels(row, a, height, sun, table, levels, at):  # type: ignore[no-untyped-def]
    """A row (3 n,) of a small map, of the directions (a, 1, height); the sun's are alike."""
    n = np.uintp(a.size)
    _glow_places(at.inverse, a, height, sun, at.piece, at.place)
    for j in range(n):
        piece = np.uintp(at.piece[j])
        light_of_texel(at.light, table, piece, at.place[j], at.factors, at.root[j], levels, j)
    for k in range(np.uintp(0), np.uintp(3) * n, _PAIR):
        encode_numbers(at.encoded, k, at.light, k)
    for k in range(row.size):
        row[k] = at.encoded[k]


@njit(inline="always", **COMPILE)
def _first_texel(block, n):  # type: ignore[no-untyped-def]
    """The last block ends with the row."""
    return min(block * _BLOCK, n - _BLOCK)


@njit(**COMPILE)
def _light_blocks(row, a, centres, height, sun, table, levels, at):  # type: ignore[no-untyped-def]
    """As `_light_texels`, a row of a large map."""
    n, stride = np.uintp(a.size), np.uintp(at.root.size)
    _glow_pieces(at.of_centres, centres, height, sun, at.piece, at.start, at.sign)
    # Separate loops: the processor then waits neither for roots nor for pieces.
    for block in range(np.uintp(centres.size)):
        place_block(
            at.place, block * _BLOCK, at.start[block], at.sign[block],
            a, at.inverse, _first_texel(block, n), height, sun,
        )  # fmt: skip
    for block in range(np.uintp(centres.size)):
        light_of_block(
            row, _first_texel(block, n), table, np.uintp(at.piece[block]),
            at.place, block * _BLOCK, at.factors, stride, at.root, levels,
        )  # fmt: skip


@njit(**COMPILE)
def _encode_row(row, light):  # type: ignore[no-untyped-def]
    """Writes a row (3 n,) of a large map, `light` in its numbers."""
    for k in range(np.uintp(0), np.uintp(row.size), _PAIR):
        # The last numbers end with the row.
        first = min(k, np.uintp(row.size) - _PAIR)
        encode_numbers(row, first, light, first)


@njit(**COMPILE)
def _fill(out, faces, top, suns, rows, a, centres, tables, at, light):  # type: ignore[no-untyped-def]
    """Rows `rows[0]` to `rows[1]` of the sky in `out` (6, n, 3 n).

    `faces` (k,) are sides, or the top twice; `suns` (6, 3) are those of `_in_face_axes`. Rows of
    large maps pass through `light` (3 n,), unless it is None.
    """
    n, (first, last), (glow, zenith, levels) = a.size, rows, tables
    for i in range(first, last):
        # Rows of the top at equal distances from the middle share their zenith angles.
        mirrored = n - 1 - i if top else i
        if top and first <= mirrored < i:
            continue
        up = _ONE if top else -a[i]
        _zenith_row(up, _ONE + a[i] * a[i], a, centres, zenith, at)
        for k in range(1 if top and not i < mirrored < last else faces.size):
            face, row = faces[k], mirrored if k else i
            height = a[row] if top else up
            sun = (suns[face, 0], suns[face, 1], suns[face, 2])
            if n < _BLOCKS_FROM:
                _light_texels(out[face, row], a, height, sun, glow, levels, at)
            elif light is None:
                _light_blocks(out[face, row], a, centres, height, sun, glow, levels, at)
            else:
                # Bytes take more arithmetic; a separate loop has the processor's widest vectors.
                _light_blocks(light, a, centres, height, sun, glow, levels, at)
                _encode_row(out[face, row], light)


def _spaces(size: int, dtype: type[np.generic]) -> _Spaces:
    n = size + 2 * BLOCK
    inverse, root, of_centres, start, sign, place = (np.zeros(n, np.float32) for _ in range(6))
    factors, light = np.zeros(4 * n, np.float32), np.zeros(3 * n, np.float32)
    piece, encoded = np.zeros(n, np.int32), np.zeros(3 * n, dtype)
    return _Spaces(inverse, root, factors, of_centres, piece, start, sign, place, light, encoded)


def fill_cube(
    distribution: FloatArray,
    mean_radiance: FloatArray,
    sun_azimuth_rad: float,
    sun_elevation_rad: float,
    size: int,
    out: NDArray[Any] | None,
    faces: tuple[int, ...],
    rows: tuple[int, int] | None = None,
    dtype: type[np.generic] = np.float32,
) -> NDArray[Any]:
    """A cube map (6, size, size, 3) of the formula, clamped at 0, 0 below the horizon.

    `distribution` (3, 9) and `mean_radiance` (3,) are the formula's numbers; the sun may also be
    below the horizon. `dtype` is float32; float16, clipped at 65504; or uint8, 255 (1 - 2^-x) of a
    radiance x. See `HosekWilkieSky.cube_map` for the rest.

    Raises:
        ValueError: for an `out` of another shape, type or layout, a face not in 0 to 5, or
            rows that do not exist.
    """
    cube = _checked_cube(_checked_size(size), dtype, out, faces)
    first, last = _checked_rows(size, rows)
    # Compiled code has no halves: it writes their bits.
    view = cube.view(np.uint16 if dtype == np.float16 else dtype).reshape(6, size, 3 * size)
    sides = [face for face in SIDES if face in faces]
    top = [TOP, TOP] if TOP in faces else []
    if sides or top:
        a, centres = _centres(size)
        suns = _in_face_axes(sun_azimuth_rad, sun_elevation_rad)
        tables = sky_tables(distribution, mean_radiance)
        spaces = _spaces(size, view.dtype.type)
        light = spaces.light if dtype == np.uint8 else None
        for some, is_top, end in ((sides, False, min(last, size // 2)), (top, True, last)):
            if some:
                numbers = np.array(some, np.intp)
                _fill(view, numbers, is_top, suns, (first, end), a, centres, tables, spaces, light)
    if out is None:
        return cube
    # Bytes are cleared in half the time that other numbers take.
    dark = view.view(np.uint8)
    for face in sides:
        dark[face, max(size // 2, first) : last].fill(0)
    if BOTTOM in faces:
        dark[BOTTOM, first:last].fill(0)
    return cube


@lru_cache(maxsize=8)
def _centres(size: int) -> tuple[Float32Array, Float32Array]:
    """Face coordinates of the texels' centres, and of the centres of a row's blocks."""
    texels = np.minimum(BLOCK * np.arange(-(-size // BLOCK)), max(size - BLOCK, 0))
    centres = (2.0 * texels + BLOCK) / size - 1.0
    return texel_centres(size).astype(np.float32), centres.astype(np.float32)


def _checked_size(size: int) -> int:
    """The edge of a cube map's faces in texels."""
    return as_count("size", size, 1, LARGEST_SIZE)


def _checked_cube(
    size: int, dtype: type[np.generic], out: NDArray[Any] | None, faces: tuple[int, ...]
) -> NDArray[Any]:
    """`out`, or a new map of zeros if it is None; ValueError if `out` does not fit."""
    check_type("faces", faces, tuple, list)
    for face in faces:
        as_count(_NAME_OF_FACES, face, 0, len(FACES) - 1)
    shape = (6, size, size, 3)
    if out is None:
        return np.zeros(shape, dtype)
    check_output(out, shape, dtype)
    return out


def _checked_rows(size: int, rows: tuple[int, int] | None) -> tuple[int, int]:
    if rows is None:
        return 0, size
    if not isinstance(rows, tuple) or len(rows) != 2:
        raise ValueError(f"rows must be two whole numbers from 0 to {size}, not {shown(rows)}")
    first, last = (as_count("rows", row, 0, size) for row in rows)
    if first > last:
        raise ValueError(f"rows must run upwards within 0 to {size}, not from {first} to {last}")
    return first, last


def _in_face_axes(sun_azimuth_rad: float, sun_elevation_rad: float) -> Float32Array:
    """The sun (6, 3) along each face's s axis, its normal, and up; of the top, along t."""
    level = math.cos(sun_elevation_rad)
    x, z = level * math.sin(sun_azimuth_rad), -level * math.cos(sun_azimuth_rad)
    return (_AXES @ (x, math.sin(sun_elevation_rad), z)).astype(np.float32)

"""The Hosek-Wilkie cube map in single precision, half precision or tone-mapped bytes.

A row of texels takes three short passes: the zenith's part (shared by the four side faces and by
the two halves of a row), places in the glow table (a loop that vectorises over texels), and the
look-up of all three colours at once. `sky_tables` describes the tables, `texel_lanes` the look-up.
"""

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dynamic_skylight.hosek_wilkie.sky_tables import (
    COMPILE,
    glow_place,
    sky_tables,
    zenith_place,
)
from dynamic_skylight.hosek_wilkie.texel_lanes import TEXELS, look_up_zenith, shade_texels
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
_GROUP, _COLOURS = np.uintp(TEXELS), np.uintp(3)


@njit(**COMPILE)
def _zenith_row(up, rest, a, table, inverse, first, share, factors, terms):  # type: ignore[no-untyped-def]
    """1 / length (n,) of a row's directions, and `look_up_zenith`'s numbers: they are even in a."""
    n = a.size
    half = (n + 1) // 2
    for j in range(half):
        q = _ONE / math.sqrt(rest + a[j] * a[j])
        inverse[j] = q
        first[j], share[j] = zenith_place(up * q)
    for j in range(half):
        mirrored = n - 1 - j
        inverse[mirrored] = inverse[j]
        look_up_zenith(
            factors, terms, table, np.uintp(first[j]), share[j], np.uintp(j), np.uintp(mirrored)
        )


@njit(**COMPILE)
def _glow_row(inverse, a, out, up, sun, first, share):  # type: ignore[no-untyped-def]
    """Places of the directions (a, out, up) in the glow table; `sun` (3,) is in the same axes."""
    for j in range(a.size):
        q = inverse[j]
        first[j], share[j] = glow_place(a[j] * q, out * q, up * q, sun)


@njit(**COMPILE)
def _shade_row(row, count, table, first, share, factors, terms, rest):  # type: ignore[no-untyped-def]
    """The row (3 n,) of `count` texels; the other arrays go on to a whole group of texels."""
    groups = np.uintp((count - 1) // TEXELS)
    for group in range(groups):
        texel = group * _GROUP
        shade_texels(row, texel * _COLOURS, table, first, share, texel, factors, terms)
    # The last group must not write beyond the row.
    texel = groups * _GROUP
    shade_texels(rest, np.uintp(0), table, first, share, texel, factors, terms)
    for k in range(np.uintp(3 * count) - texel * _COLOURS):
        row[texel * _COLOURS + k] = rest[k]


@njit(**COMPILE)
def _fill(out, sides, suns, top, rows, a, tables, spaces):  # type: ignore[no-untyped-def]
    """Rows `rows[0]` to `rows[1]` of the sky in `out` (6, n, 3 n).

    `suns` (6, 3) are those of `_in_face_axes`, `sides` (k,) faces, `tables` and `spaces` those of
    `sky_tables` and `_spaces`.
    """
    n, (first, last), (glow, zenith) = a.size, rows, tables
    inverse, place, share, factors, terms, rest = spaces
    for i in range(first, min(last, n // 2) if sides.size else first):
        up = -a[i]
        _zenith_row(up, _ONE + up * up, a, zenith, inverse, place, share, factors, terms)
        for face in sides:
            sun = (suns[face, 0], suns[face, 1], suns[face, 2])
            _glow_row(inverse, a, _ONE, up, sun, place, share)
            _shade_row(out[face, i], n, glow, place, share, factors, terms, rest)
    sun = (suns[TOP, 0], suns[TOP, 1], suns[TOP, 2])
    for i in range(first, last if top else first):
        # Rows at equal distances from the middle share their zenith angles.
        mirrored = n - 1 - i
        if first <= mirrored < i:
            continue
        _zenith_row(_ONE, _ONE + a[i] * a[i], a, zenith, inverse, place, share, factors, terms)
        for k in (i, mirrored):
            if k == i or i < k < last:
                _glow_row(inverse, a, _ONE, a[k], sun, place, share)
                _shade_row(out[TOP, k], n, glow, place, share, factors, terms, rest)


def _spaces(size: int, dtype: type[np.generic]) -> tuple[NDArray[Any], ...]:
    """Arrays that rows overwrite, as long as the last group of texels.

    They are separate: in rows of one array the loops would not compile to vector code.
    """
    n = size + TEXELS
    return (
        np.empty(n, np.float32),
        np.zeros(n, np.int32),
        np.zeros(n, np.float32),
        np.zeros(4 * n, np.float32),
        np.zeros(4 * n, np.float32),
        np.empty(3 * TEXELS + 1, dtype),
    )


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
    top = TOP in faces
    if sides or top:
        _fill(
            view, np.array(sides, np.intp), _in_face_axes(sun_azimuth_rad, sun_elevation_rad),
            top, (first, last), _centres(size), sky_tables(distribution, mean_radiance),
            _spaces(size, view.dtype.type),
        )  # fmt: skip
    if out is None:
        return cube
    for face in sides:
        view[face, max(size // 2, first) : last] = 0
    if BOTTOM in faces:
        view[BOTTOM, first:last] = 0
    return cube


@lru_cache(maxsize=8)
def _centres(size: int) -> Float32Array:
    return texel_centres(size).astype(np.float32)


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

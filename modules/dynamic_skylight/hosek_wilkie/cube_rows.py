"""The Hosek-Wilkie cube map in single precision: row kernels that compile to vector code.

There are no tables and no branches: the elementary functions are polynomials, and one loop
computes all three colours of a row. Terms of the zenith angle alone are computed once per row
and shared by the four side faces. `fast_formula` explains how single precision stays accurate.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dynamic_skylight.hosek_wilkie.fast_formula import (
    ANGLE_POLYNOMIAL,
    EXP2M1_POLYNOMIAL,
    fold,
)
from dynamic_skylight.hosek_wilkie.formula import HORIZON_OFFSET
from vrut_lite.arguments import as_count, check_output, check_type, shown
from vrut_lite.geometry.cube_map import FACE_NORMALS, FACE_S_AXES, FACES, texel_centres
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.njit import SUMS_IN_ORDER, njit
from vrut_lite.numeric_types import Float32Array, FloatArray

SIDES = (0, 1, 4, 5)
TOP, BOTTOM = 2, 3
# Six faces of this size, in single precision, take 4.8 GB.
LARGEST_SIZE = 8192
_NAME_OF_FACES = f"faces, numbered in the order {', '.join(FACES)},"
COMPILE: dict[str, Any] = {
    "cache": True,
    "error_model": "numpy",
    "fastmath": SUMS_IN_ORDER,
}


_P0, _P1, _P2, _P3, _P4, _P5, _P6 = ANGLE_POLYNOMIAL
_Q0, _Q1, _Q2, _Q3, _Q4 = EXP2M1_POLYNOMIAL
_ZERO, _ONE, _TWO, _FOUR = (np.float32(v) for v in (0, 1, 2, 4))
_HALF, _PI = np.float32(0.5), np.float32(np.pi)
LEAST_EXPONENT = np.float32(-100.0)
_OFFSET = np.float32(HORIZON_OFFSET)
_ROUNDER = np.float32(1.5 * 2**23)
_BITS_OF_ONE, _MANTISSA_BITS = np.int32(127 << 23), np.int32(23)


@njit(inline="always", **COMPILE)
def exp2m1(y):  # type: ignore[no-untyped-def]
    """2^y - 1 = 2^n (2^f - 1) + (2^n - 1), |f| <= 1/2: exact near y = 0. |y| <= 126.

    Adding 1.5 * 2^23 rounds to an integer in the low bits.
    """
    shifted = np.float32(y + _ROUNDER)
    f = y - (shifted - _ROUNDER)
    power = np.int32((shifted.view(np.int32) << _MANTISSA_BITS) + _BITS_OF_ONE).view(np.float32)
    q = _Q0 + f * (_Q1 + f * (_Q2 + f * (_Q3 + f * _Q4)))
    return power * (f * q) + (power - _ONE)


@njit(inline="always", **COMPILE)
def _angle(u):  # type: ignore[no-untyped-def]
    """The angle whose squared chord is u in [0, 4]; mirrored beyond a right angle."""
    v = min(u, _FOUR - u)
    p = _P0 + v * (_P1 + v * (_P2 + v * (_P3 + v * (_P4 + v * (_P5 + v * _P6)))))
    near = math.sqrt(max(v, _ZERO)) * p
    return near if u <= _TWO else _PI - near


@njit(inline="always", **COMPILE)
def _glow(gamma, u, cos_gamma, sqrt_cos_theta, p):  # type: ignore[no-untyped-def]
    """The formula's second factor; p as `fold` orders it, from the fourth number on."""
    CD, D, E, F, G, gap, I, H = p  # noqa: E741 (the paper's letters)
    square = cos_gamma * cos_gamma
    t = _ONE / (gap + I * u)
    chi = (_ONE + square) * t * math.sqrt(t)
    return CD + D * exp2m1(E * gamma) + F * square + G * chi + H * sqrt_cos_theta


@njit(inline="always", **COMPILE)
def _zenith(x, base, factor, decay):  # type: ignore[no-untyped-def]
    """The formula's first factor times the radiance; x = 1 / (cos theta + 0.01)."""
    # 2^-100 is negligible beside 1; B' and E' keep all other exponents in exp2m1's range.
    return base + factor * exp2m1(max(decay * x, LEAST_EXPONENT))


@njit(**COMPILE)
def _zenith_row(zenith, up, rest, a, p):  # type: ignore[no-untyped-def]
    """Rows (5, n): 1 / length, sqrt(cos theta), and the first factor times radiance (3)."""
    # Separate variables: the compiler must assume that a store into `zenith` changes an array.
    inverse, root, red, green, blue = zenith[0], zenith[1], zenith[2], zenith[3], zenith[4]
    r0, r1, r2 = p[0, 0], p[0, 1], p[0, 2]
    g0, g1, g2 = p[1, 0], p[1, 1], p[1, 2]
    b0, b1, b2 = p[2, 0], p[2, 1], p[2, 2]
    for j in range(a.size):
        q = _ONE / math.sqrt(rest + a[j] * a[j])
        c = up * q
        x = _ONE / (c + _OFFSET)
        inverse[j] = q
        root[j] = math.sqrt(c)
        red[j] = _zenith(x, r0, r1, r2)
        green[j] = _zenith(x, g0, g1, g2)
        blue[j] = _zenith(x, b0, b1, b2)


@njit(inline="always", **COMPILE)
def _glow_numbers(p):  # type: ignore[no-untyped-def]
    return p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10]


@njit(**COMPILE)
def _sky_row(row, zenith, a, other, sun, p):  # type: ignore[no-untyped-def]
    """One row (n, 3) whose directions are (a, *other) in the axes in which `sun` is given."""
    red, green, blue = _glow_numbers(p[0]), _glow_numbers(p[1]), _glow_numbers(p[2])
    inverse, roots = zenith[0], zenith[1]
    zenith_red, zenith_green, zenith_blue = zenith[2], zenith[3], zenith[4]
    for j in range(a.size):
        q, root = inverse[j], roots[j]
        x, y, z = a[j] * q - sun[0], other[0] * q - sun[1], other[1] * q - sun[2]
        u = x * x + y * y + z * z
        cos_gamma = _ONE - _HALF * u
        gamma = _angle(u)
        row[3 * j] = max(zenith_red[j] * _glow(gamma, u, cos_gamma, root, red), _ZERO)
        row[3 * j + 1] = max(zenith_green[j] * _glow(gamma, u, cos_gamma, root, green), _ZERO)
        row[3 * j + 2] = max(zenith_blue[j] * _glow(gamma, u, cos_gamma, root, blue), _ZERO)


@njit(**COMPILE)
def _fill_top(out, first, last, offset, a, sun, p):  # type: ignore[no-untyped-def]
    """Rows `first` to `last` of the top face; sun along s, up and along t.

    Rows at equal distances from the middle share their zenith angles.
    """
    zenith = np.empty((5, a.size), np.float32)
    for i in range(first, last):
        mirrored = a.size - 1 - i
        if first <= mirrored < i:
            continue
        _zenith_row(zenith, _ONE, _ONE + a[i] * a[i], a, p)
        _sky_row(out[i - offset], zenith, a, (_ONE, a[i]), sun, p)
        if i < mirrored < last:
            _sky_row(out[mirrored - offset], zenith, a, (_ONE, a[mirrored]), sun, p)


@njit(**COMPILE)
def _fill_sides(out, places, first, last, offset, a, suns, p):  # type: ignore[no-untyped-def]
    """Rows `first` to `last` of side faces; suns (k, 3): along s, out, up."""
    zenith = np.empty((5, a.size), np.float32)
    for i in range(first, last):
        up = -a[i]
        _zenith_row(zenith, up, _ONE + up * up, a, p)
        for k in range(places.size):
            sun = (suns[k, 0], suns[k, 1], suns[k, 2])
            _sky_row(out[places[k], i - offset], zenith, a, (_ONE, up), sun, p)


class SkyRows:
    """Computes rows of one sky's cube map into given arrays.

    `distribution` (3, 9) and `mean_radiance` (3,) are the formula's numbers; the sun may also be
    below the horizon. Row i is written to row i - `offset` of `out`, which is C-contiguous with
    rows of (3 size,).
    """

    def __init__(
        self,
        distribution: FloatArray,
        mean_radiance: FloatArray,
        sun_azimuth_rad: float,
        sun_elevation_rad: float,
        size: int,
    ):
        self.size = checked_size(size)
        self._sun = world_from_enu(direction_from_angles(sun_azimuth_rad, sun_elevation_rad))
        self._a = texel_centres(size).astype(np.float32)
        self._numbers = fold(distribution, mean_radiance)

    def top(self, out: Float32Array, first: int, last: int, offset: int = 0) -> None:
        """Write rows of the top face into `out` (m, 3 size)."""
        x, y, z = (np.float32(v) for v in self._sun)
        _fill_top(out, first, last, offset, self._a, (x, y, z), self._numbers)

    def sides(
        self,
        out: Float32Array,
        places: NDArray[np.intp],
        faces: NDArray[np.intp],
        first: int,
        last: int,
        offset: int = 0,
    ) -> None:
        """Write the rows above the horizon of side faces, faces[k] to out[places[k]]."""
        last = min(last, self.size // 2)
        suns = _in_face_axes(self._sun, faces)
        _fill_sides(out, places, first, last, offset, self._a, suns, self._numbers)


def fill_cube(
    distribution: FloatArray,
    mean_radiance: FloatArray,
    sun_azimuth_rad: float,
    sun_elevation_rad: float,
    size: int,
    out: Float32Array | None,
    faces: tuple[int, ...],
    rows: tuple[int, int] | None = None,
) -> Float32Array:
    """A cube map (6, size, size, 3) of the formula, clamped at 0, 0 below the horizon.

    See `SkyRows` for the sky and `HosekWilkieSky.cube_map` for the rest.

    Raises:
        ValueError: for an `out` of another shape, type or layout, a face not in 0 to 5, or
            rows that do not exist.
    """
    cube = checked_cube(checked_size(size), np.float32, out, faces)
    first, last = _checked_rows(size, rows)
    sky = SkyRows(distribution, mean_radiance, sun_azimuth_rad, sun_elevation_rad, size)
    view = cube.reshape(6, size, 3 * size)
    sides = side_faces(faces)
    sky.sides(view, sides, sides, first, last)
    for face in sides:
        view[face, max(size // 2, first) : last] = 0.0
    if TOP in faces:
        sky.top(view[TOP], first, last)
    if BOTTOM in faces:
        view[BOTTOM, first:last] = 0.0
    return cube


def side_faces(faces: tuple[int, ...]) -> NDArray[np.intp]:
    """The side faces among `faces`."""
    return np.array([face for face in SIDES if face in faces], dtype=np.intp)


def checked_size(size: int) -> int:
    """The edge of a cube map's faces in texels."""
    return as_count("size", size, 1, LARGEST_SIZE)


def checked_cube(
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


def _in_face_axes(sun: FloatArray, faces: NDArray[np.intp]) -> Float32Array:
    """The sun (k, 3) along each side face's s axis, its normal, and up."""
    along, out = FACE_S_AXES[faces] @ sun, FACE_NORMALS[faces] @ sun
    axes = np.array([along, out, np.full_like(out, sun[1])])
    return axes.T.astype(np.float32, order="C")

"""The Hosek-Wilkie cube map in single precision: row kernels that compile to vector code.

No tables and no branches: the elementary functions are polynomials, and a row's texels go
through one loop over its three colours. What depends on the zenith angle alone is worked out
once per row and shared by the four side faces. Three rearrangements keep float32 accurate:

* the angle from the sun comes from the chord u = |d - s|^2 = 2 - 2 cos gamma, summed from
  differences of components, not from cos gamma, which is flat at the sun;
* chi's denominator 1 + I^2 - 2 I cos gamma is (1 - I)^2 + I u;
* C + D exp(E gamma), where C and D reach 50 with opposite signs, is (C + D) + D expm1(E gamma),
  with C + D formed in float64; 1 + A exp(...) likewise.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from dynamic_skylight.hosek_wilkie.formula import HORIZON_OFFSET
from vrut_lite.geometry.cube_map import FACE_NORMALS, FACE_S_AXES, FACES, texel_centres
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu

FloatArray = NDArray[np.float64]
Float32Array = NDArray[np.float32]

SIDES = (0, 1, 4, 5)
TOP, BOTTOM = 2, 3
# No reassociation: the result must not depend on the width of the vectors.
_COMPILE: dict[str, Any] = {
    "cache": True,
    "error_model": "numpy",
    "fastmath": {"nnan", "ninf", "nsz", "contract"},
}


def _fit(
    function: Callable[[FloatArray], FloatArray], lower: float, upper: float, degree: int
) -> tuple[np.float32, ...]:
    """Power coefficients, constant first, of a polynomial fitted at Chebyshev nodes."""
    fit = np.polynomial.Chebyshev.interpolate(function, degree, domain=[lower, upper])
    return tuple(fit.convert(kind=np.polynomial.Polynomial).coef.astype(np.float32))


def _angle_over_chord(u: FloatArray) -> FloatArray:
    return 2.0 * np.arcsin(np.sqrt(u) / 2.0) / np.sqrt(u)


def _exp2m1_over_x(x: FloatArray) -> FloatArray:
    limit = np.full_like(x, np.log(2.0))
    return np.divide(np.expm1(np.log(2.0) * x), x, out=limit, where=x != 0.0)


# Relative errors of both: below 2e-7, about float32's own.
_P0, _P1, _P2, _P3, _P4, _P5, _P6 = _fit(_angle_over_chord, 0.0, 2.0, 6)
_Q0, _Q1, _Q2, _Q3, _Q4, _Q5, _Q6 = _fit(_exp2m1_over_x, -1.0, 1.0, 6)
_ZERO, _ONE, _TWO, _FOUR = (np.float32(v) for v in (0, 1, 2, 4))
_HALF, _PI = np.float32(0.5), np.float32(np.pi)
_LOG2_E, _LIMIT = np.float32(1.0 / np.log(2.0)), np.float32(126.0)
_OFFSET = np.float32(HORIZON_OFFSET)
_BIAS, _MANTISSA_BITS = np.int32(127), np.int32(23)


@njit(inline="always", **_COMPILE)
def _expm1(x):  # type: ignore[no-untyped-def]
    """exp(x) - 1 = 2^n (2^f - 1) + (2^n - 1) with n = trunc(x log2 e): exact near x = 0."""
    y = min(max(x * _LOG2_E, -_LIMIT), _LIMIT)
    n = np.int32(y)
    f = y - np.float32(n)
    power = np.int32((n + _BIAS) << _MANTISSA_BITS).view(np.float32)
    q = _Q0 + f * (_Q1 + f * (_Q2 + f * (_Q3 + f * (_Q4 + f * (_Q5 + f * _Q6)))))
    return power * (f * q) + (power - _ONE)


@njit(inline="always", **_COMPILE)
def _angle(u):  # type: ignore[no-untyped-def]
    """The angle whose squared chord is u in [0, 4]; mirrored beyond a right angle."""
    v = min(u, _FOUR - u)
    p = _P0 + v * (_P1 + v * (_P2 + v * (_P3 + v * (_P4 + v * (_P5 + v * _P6)))))
    near = math.sqrt(max(v, _ZERO)) * p
    return near if u <= _TWO else _PI - near


@njit(inline="always", **_COMPILE)
def _glow(gamma, u, cos_gamma, sqrt_cos_theta, p):  # type: ignore[no-untyped-def]
    """The formula's second factor; p as `_fold` orders it, from the fourth number on."""
    CD, D, E, F, G, gap, I, H = p  # noqa: E741 (the paper's letters)
    square = cos_gamma * cos_gamma
    t = _ONE / (gap + I * u)
    chi = (_ONE + square) * t * math.sqrt(t)
    return CD + D * _expm1(E * gamma) + F * square + G * chi + H * sqrt_cos_theta


@njit(**_COMPILE)
def _zenith_row(zenith, up, rest, a, p):  # type: ignore[no-untyped-def]
    """Rows (5, n): 1 / length, sqrt(cos theta), and the first factor times radiance (3)."""
    for j in range(a.size):
        q = _ONE / math.sqrt(rest + a[j] * a[j])
        c = up * q
        zenith[0, j] = q
        zenith[1, j] = math.sqrt(c)
        x = _ONE / (c + _OFFSET)
        zenith[2, j] = p[0, 0] + p[0, 1] * _expm1(p[0, 2] * x)
        zenith[3, j] = p[1, 0] + p[1, 1] * _expm1(p[1, 2] * x)
        zenith[4, j] = p[2, 0] + p[2, 1] * _expm1(p[2, 2] * x)


@njit(inline="always", **_COMPILE)
def _glow_numbers(p):  # type: ignore[no-untyped-def]
    return p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10]


@njit(**_COMPILE)
def _sky_row(row, zenith, a, other, sun, p):  # type: ignore[no-untyped-def]
    """One row (n, 3) whose directions are (a, *other) in the axes in which `sun` is given."""
    red, green, blue = _glow_numbers(p[0]), _glow_numbers(p[1]), _glow_numbers(p[2])
    for j in range(a.size):
        q, root = zenith[0, j], zenith[1, j]
        x, y, z = a[j] * q - sun[0], other[0] * q - sun[1], other[1] * q - sun[2]
        u = x * x + y * y + z * z
        cos_gamma = _ONE - _HALF * u
        gamma = _angle(u)
        row[3 * j] = max(zenith[2, j] * _glow(gamma, u, cos_gamma, root, red), _ZERO)
        row[3 * j + 1] = max(zenith[3, j] * _glow(gamma, u, cos_gamma, root, green), _ZERO)
        row[3 * j + 2] = max(zenith[4, j] * _glow(gamma, u, cos_gamma, root, blue), _ZERO)


@njit(**_COMPILE)
def _fill_top(face, a, sun, p):  # type: ignore[no-untyped-def]
    """The face that looks up, (n, 3 n); sun along s, up and along t."""
    zenith = np.empty((5, a.size), np.float32)
    for i in range(a.size):
        _zenith_row(zenith, _ONE, _ONE + a[i] * a[i], a, p)
        _sky_row(face[i], zenith, a, (_ONE, a[i]), sun, p)


@njit(**_COMPILE)
def _fill_sides(cube, wanted, a, suns, p):  # type: ignore[no-untyped-def]
    """The rows above the horizon of side faces (6, n, 3 n); suns (4, 3): along s, out, up."""
    zenith = np.empty((5, a.size), np.float32)
    for i in range(a.size // 2):
        up = -a[i]
        _zenith_row(zenith, up, _ONE + up * up, a, p)
        for k in range(wanted.size):
            sun = (suns[k, 0], suns[k, 1], suns[k, 2])
            _sky_row(cube[wanted[k], i], zenith, a, (_ONE, up), sun, p)


def fill_cube(
    distribution: FloatArray,
    mean_radiance: FloatArray,
    sun_azimuth_rad: float,
    sun_elevation_rad: float,
    size: int,
    out: Float32Array | None,
    faces: tuple[int, ...],
) -> Float32Array:
    """A cube map (6, size, size, 3) of the formula, clamped at 0, 0 below the horizon.

    `distribution` (3, 9) and `mean_radiance` (3,) are the formula's numbers; the sun may
    stand anywhere, also below the horizon. See `HosekWilkieSky.cube_map` for the rest.

    Raises:
        ValueError: for an `out` of another shape, type or layout, or a face not in 0 to 5.
    """
    cube = _checked(size, out, faces)
    sun = world_from_enu(direction_from_angles(sun_azimuth_rad, sun_elevation_rad))
    a = texel_centres(size).astype(np.float32)
    p = _fold(distribution, mean_radiance)
    rows = cube.reshape(6, size, 3 * size)
    sides = np.array([face for face in SIDES if face in faces], dtype=np.intp)
    _fill_sides(rows, sides, a, _in_face_axes(sun, sides), p)
    rows[sides, size // 2 :] = 0.0
    if TOP in faces:
        _fill_top(rows[TOP], a, (np.float32(sun[0]), np.float32(sun[1]), np.float32(sun[2])), p)
    if BOTTOM in faces:
        rows[BOTTOM] = 0.0
    return cube


def _checked(size: int, out: Float32Array | None, faces: tuple[int, ...]) -> Float32Array:
    if any(face not in range(len(FACES)) for face in faces):
        raise ValueError(f"faces are numbered 0 to 5 in the order {FACES}, not {faces}")
    shape = (6, size, size, 3)
    if out is None:
        return np.zeros(shape, np.float32)
    if out.shape != shape or out.dtype != np.float32 or not out.flags.c_contiguous:
        raise ValueError(
            f"out must be a C-contiguous float32 array of shape {shape}, "
            f"not {out.dtype} of shape {out.shape}"
        )
    return out


def _in_face_axes(sun: FloatArray, faces: NDArray[np.intp]) -> Float32Array:
    """The sun (k, 3) along each side face's s axis, its normal, and up."""
    along, out = FACE_S_AXES[faces] @ sun, FACE_NORMALS[faces] @ sun
    return np.stack([along, out, np.full_like(out, sun[1])], axis=-1).astype(np.float32)


def _fold(distribution: FloatArray, mean_radiance: FloatArray) -> Float32Array:
    """Eleven numbers per colour (3, 11): R(1+A), RA, B, C+D, D, E, F, G, (1-I)^2, I, H."""
    A, B, C, D, E, F, G, H, I = distribution.T  # noqa: E741 (the paper's letters)
    R = mean_radiance
    folded = [R * (1 + A), R * A, B, C + D, D, E, F, G, (1 - I) ** 2, I, H]
    return np.stack(folded, axis=-1).astype(np.float32)

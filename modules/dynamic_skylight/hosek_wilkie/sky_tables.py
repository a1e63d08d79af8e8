"""Two tables that stand for the formula of one sky: its light by angle from the sun and by height.

The formula is Z(theta) (S(gamma) + H sqrt(cos theta)) in each colour. S is tabulated over the chord
w to the sun, and beyond a right angle over the chord to the point opposite: both are smooth there,
and no angle is needed. Z and Z H sqrt(cos theta) are tabulated over sqrt(cos theta). Each interval
holds a quadratic through its ends and its middle. Over all turbidities, albedos and suns the
quadratics err by at most 1e-6 of the larger of a value and a hundredth of the table's largest,
about as much as single precision; a row of texels then needs a square root each for its places in
the tables, and no exponential. `fast_formula` explains how the entries stay accurate.
"""

import math
from typing import Any

import numpy as np

from dynamic_skylight.hosek_wilkie.fast_formula import (
    ANGLE_POLYNOMIAL,
    EXP2M1_POLYNOMIAL,
    fold,
)
from dynamic_skylight.hosek_wilkie.formula import HORIZON_OFFSET
from vrut_lite.njit import SUMS_IN_ORDER, njit
from vrut_lite.numeric_types import Float32Array, FloatArray

COMPILE: dict[str, Any] = {
    "cache": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": SUMS_IN_ORDER,
}
# Intervals towards the sun, as many away from it, and as many of the zenith's table.
INTERVALS = 256
# Numbers of an interval: three coefficients of red, green, blue and a pad; twice that by height.
GLOW_NUMBERS, ZENITH_NUMBERS = 12, 24
# First number of the zenith table's interval of zeros.
BELOW_HORIZON = INTERVALS * ZENITH_NUMBERS

_P0, _P1, _P2, _P3, _P4, _P5, _P6 = ANGLE_POLYNOMIAL
_Q0, _Q1, _Q2, _Q3, _Q4 = EXP2M1_POLYNOMIAL
_ZERO, _ONE, _TWO, _FOUR = (np.float32(v) for v in (0, 1, 2, 4))
_HALF, _PI = np.float32(0.5), np.float32(np.pi)
_LEAST_EXPONENT = np.float32(-100.0)
_OFFSET = np.float32(HORIZON_OFFSET)
_ROUNDER = np.float32(1.5 * 2**23)
_BITS_OF_ONE, _MANTISSA_BITS = np.int32(127 << 23), np.int32(23)
# The chord of a right angle is the root of two.
_GLOW_SCALE = np.float32(INTERVALS / math.sqrt(2.0))
_GLOW_STEP = np.float32(math.sqrt(0.5) / INTERVALS)
_AWAY = np.int32(INTERVALS * GLOW_NUMBERS)
_GLOW_STRIDE, _NO_OFFSET = np.int32(GLOW_NUMBERS), np.int32(0)
_ZENITH_SCALE, _ZENITH_STEP = np.float32(INTERVALS), np.float32(0.5 / INTERVALS)
_ZENITH_STRIDE = np.int32(ZENITH_NUMBERS)
# The last place within a table's intervals.
_END = np.nextafter(np.float32(INTERVALS), np.float32(0.0))


@njit(inline="always", **COMPILE)
def _exp2m1(y):  # type: ignore[no-untyped-def]
    """2^y - 1 = 2^n (2^f - 1) + (2^n - 1), |f| <= 1/2: exact near y = 0. |y| <= 126.

    Adding 1.5 * 2^23 rounds to an integer in the low bits.
    """
    shifted = np.float32(y + _ROUNDER)
    f = y - (shifted - _ROUNDER)
    power = np.int32((shifted.view(np.int32) << _MANTISSA_BITS) + _BITS_OF_ONE).view(np.float32)
    q = _Q0 + f * (_Q1 + f * (_Q2 + f * (_Q3 + f * _Q4)))
    return power * (f * q) + (power - _ONE)


@njit(**COMPILE)
def fill_tables(numbers, glow, zenith, values):  # type: ignore[no-untyped-def]
    """The flat tables of a sky's `numbers` (3, 11), those of `fold`.

    `glow` has the intervals towards the sun, then those away from it. `zenith` has Z, then Z H
    sqrt(cos theta), of every interval. Of both, pads and `BELOW_HORIZON` stay as they are. `values`
    (2 INTERVALS + 1,) are overwritten.
    """
    for c in range(3):
        p = numbers[c]
        for away in range(2):
            for k in range(values.size):
                w = np.float32(k) * _GLOW_STEP
                v = w * w
                angle = _P0 + v * (_P1 + v * (_P2 + v * (_P3 + v * (_P4 + v * (_P5 + v * _P6)))))
                angle *= w
                angle, u = (_PI - angle, _FOUR - v) if away else (angle, v)
                cosine = _ONE - _HALF * u
                square = cosine * cosine
                t = _ONE / (p[8] + p[9] * u)
                chi = (_ONE + square) * t * math.sqrt(t)
                values[k] = p[3] + p[4] * _exp2m1(p[5] * angle) + p[6] * square + p[7] * chi
            _quadratics(values, glow, away * _AWAY + c, GLOW_NUMBERS, 4)
        for rooted in range(2):
            for k in range(values.size):
                root = np.float32(k) * _ZENITH_STEP
                # 2^-100 is negligible beside 1; B' keeps all other exponents in range.
                exponent = max(p[2] / (root * root + _OFFSET), _LEAST_EXPONENT)
                z = p[0] + p[1] * _exp2m1(exponent)
                values[k] = z * root * p[10] if rooted else z
            _quadratics(values, zenith, 4 * rooted + c, ZENITH_NUMBERS, 8)


@njit(**COMPILE)
def _quadratics(values, table, first, stride, step):  # type: ignore[no-untyped-def]
    """Coefficients through values (2 n + 1,) at ends and middles: table[first + stride k + step i].

    The powers i of an interval k begin with the constant.
    """
    for k in range(INTERVALS):
        start, middle, end = values[2 * k], values[2 * k + 1], values[2 * k + 2]
        at = first + stride * k
        table[at] = start
        table[at + step] = _FOUR * (middle - start) - (end - start)
        table[at + 2 * step] = _TWO * ((start - middle) + (end - middle))


@njit(inline="always", **COMPILE)
def glow_place(x, y, z, sun):  # type: ignore[no-untyped-def]
    """First number of the interval of a unit direction, and the share within it.

    The chord is the shorter of those to the sun and to the point opposite: summed from differences,
    it is exact near both.
    """
    away = x * sun[0] + y * sun[1] + z * sun[2] < _ZERO
    sign = -_ONE if away else _ONE
    dx, dy, dz = x - sign * sun[0], y - sign * sun[1], z - sign * sun[2]
    at = min(math.sqrt(dx * dx + dy * dy + dz * dz) * _GLOW_SCALE, _END)
    k = np.int32(at)
    return k * _GLOW_STRIDE + (_AWAY if away else _NO_OFFSET), at - np.float32(k)


@njit(inline="always", **COMPILE)
def zenith_place(cos_theta):  # type: ignore[no-untyped-def]
    """First number of the interval of a height, cos theta >= 0, and the share within it."""
    at = min(math.sqrt(cos_theta) * _ZENITH_SCALE, _END)
    k = np.int32(at)
    return k * _ZENITH_STRIDE, at - np.float32(k)


def sky_tables(distribution: FloatArray, mean_radiance: FloatArray) -> tuple[Float32Array, ...]:
    """The flat tables of a sky, of its glow and of the zenith's part.

    `distribution` (3, 9) and `mean_radiance` (3,) are the formula's numbers.
    """
    glow = np.zeros(2 * INTERVALS * GLOW_NUMBERS, np.float32)
    zenith = np.zeros((INTERVALS + 1) * ZENITH_NUMBERS, np.float32)
    values = np.empty(2 * INTERVALS + 1, np.float32)
    fill_tables(fold(distribution, mean_radiance), glow, zenith, values)
    return glow, zenith

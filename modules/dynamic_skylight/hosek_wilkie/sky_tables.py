"""Two tables that stand for the formula of one sky: its light by angle from the sun and by height.

The formula is Z(theta) (S(gamma) + H sqrt(cos theta)) in each colour. S is tabulated over the chord
to the sun, and beyond a right angle over the chord to the point opposite: both are smooth there,
and no angle is needed. Z is tabulated over sqrt(cos theta). S is in quintic pieces, Z in cubic
ones. They overlap, so that eight neighbouring texels of a large map may take the same piece: the
one about the middle of the eight. Over all turbidities, albedos and suns the pieces err by at most
2e-6 of the larger of a value and a hundredth of the map's largest, single precision by up to 7e-6
where terms cancel at the horizon. A row of texels then needs a square root each for its places in
the tables, and no exponential. `fast_formula` explains how the entries stay accurate.
"""

import math
from typing import Any

import numpy as np

from dynamic_skylight.hosek_wilkie.fast_formula import EXP2M1_POLYNOMIAL, fold
from dynamic_skylight.hosek_wilkie.formula import HORIZON_OFFSET
from vrut_lite.njit import SUMS_IN_ORDER, njit
from vrut_lite.numeric_types import Float32Array, FloatArray

COMPILE: dict[str, Any] = {
    "cache": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": SUMS_IN_ORDER,
    "_nrt": False,
}
# Numbers of a coefficient: red, green, blue and a pad.
COEFFICIENT = 4
# Pieces a unit of chord, and from the middle of a piece to its outermost nodes, in pieces: half a
# piece, and half of eight texels of a map of 256, which are at most 1 / 128 apart.
GLOW_PER_UNIT, GLOW_REACH, GLOW_DEGREE = 56, 2.0, 5
GLOW_PIECE = (GLOW_DEGREE + 1) * COEFFICIENT
# The chord of a right angle is the root of two; a block of texels may lie about it.
_GLOW_PIECES = math.ceil(GLOW_PER_UNIT * math.sqrt(2.0)) + 1
# First number of the pieces away from the sun.
AWAY = _GLOW_PIECES * GLOW_PIECE
# The root of the cosine changes by a quarter as much as the angle, at most.
ZENITH_PER_UNIT, ZENITH_REACH, ZENITH_DEGREE = 128, 1.5, 3
ZENITH_PIECE = (ZENITH_DEGREE + 1) * COEFFICIENT
# First number of the zenith table's piece of zeros.
BELOW_HORIZON = ZENITH_PER_UNIT * ZENITH_PIECE

_Q0, _Q1, _Q2, _Q3, _Q4 = EXP2M1_POLYNOMIAL
_ZERO, _ONE, _TWO, _FOUR = (np.float32(v) for v in (0, 1, 2, 4))
_HALF, _TWO_THIRDS, _PI = np.float32(0.5), np.float32(2.0 / 3.0), np.float32(np.pi)
_LEAST_EXPONENT = np.float32(-100.0)
_OFFSET = np.float32(HORIZON_OFFSET)
_ROUNDER = np.float32(1.5 * 2**23)
_BITS_OF_ONE, _MANTISSA_BITS = np.int32(127 << 23), np.int32(23)
# Nodes of a piece of the glow lie 1, 3 and 4 half pieces from its middle, on either side. There
# angles from the sun, also negative ones, the square of their chord and that of their cosine.
_GLOW_NODES = 2 * _GLOW_PIECES + 7
_TOWARDS = 2.0 * np.arcsin((np.arange(_GLOW_NODES) - 4.0) / (4.0 * GLOW_PER_UNIT))
_ANGLES = np.stack([_TOWARDS, np.pi - _TOWARDS]).astype(np.float32)
_CHORDS = (4.0 * np.sin(0.5 * np.stack([_TOWARDS, np.pi - _TOWARDS])) ** 2).astype(np.float32)
_SQUARES = np.stack([np.cos(_TOWARDS) ** 2] * 2).astype(np.float32)
# B multiplies these at the nodes of the zenith's pieces.
_ZENITH_NODES = ZENITH_PER_UNIT + 3
_DECAYS = 1.0 / (((np.arange(_ZENITH_NODES) - 1.0) / ZENITH_PER_UNIT) ** 2 + HORIZON_OFFSET)
_DECAYS = _DECAYS.astype(np.float32)
_GLOW_PIECES_A_UNIT, _GLOW_SHARE = np.float32(GLOW_PER_UNIT), np.float32(1.0 / GLOW_REACH)
_ZENITH_PIECES_A_UNIT = np.float32(ZENITH_PER_UNIT)
_ZENITH_SHARE = np.float32(1.0 / ZENITH_REACH)
# A place in a piece is the product of this and the chord, or the root of the cosine, and what
# `glow_piece` and `zenith_piece` return as the piece's start.
GLOW_SCALE = np.float32(GLOW_PER_UNIT / GLOW_REACH)
ZENITH_SCALE = np.float32(ZENITH_PER_UNIT / ZENITH_REACH)
_GLOW_STRIDE, _ZENITH_STRIDE = np.int32(GLOW_PIECE), np.int32(ZENITH_PIECE)
_AWAY, _NO_OFFSET = np.int32(AWAY), np.int32(0)
_ZENITH_LAST = np.int32(ZENITH_PER_UNIT - 1)


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

    `glow` has the pieces towards the sun, then those away from it. Of `zenith` the piece
    `BELOW_HORIZON` stays as it is. `values` (n,) are overwritten.
    """
    for c in range(3):
        p = numbers[c]
        for away in range(2):
            for k in range(_GLOW_NODES):
                u, square = _CHORDS[away, k], _SQUARES[away, k]
                t = _ONE / (p[8] + p[9] * u)
                chi = (_ONE + square) * t * math.sqrt(t)
                light = p[3] + p[4] * _exp2m1(p[5] * _ANGLES[away, k])
                values[k] = light + p[6] * square + p[7] * chi
            for k in range(_GLOW_PIECES):
                _quintic(values, 2 * k + 4, glow, away * AWAY + k * GLOW_PIECE + c)
        for k in range(_ZENITH_NODES):
            # 2^-100 is negligible beside 1; B' keeps all other exponents in range.
            exponent = max(p[2] * _DECAYS[k], _LEAST_EXPONENT)
            values[k] = p[0] + p[1] * _exp2m1(exponent)
        for k in range(ZENITH_PER_UNIT):
            _cubic(values, k, zenith, k * ZENITH_PIECE + c)


@njit(inline="always", **COMPILE)
def _quintic(values, middle, table, at):  # type: ignore[no-untyped-def]
    """The piece through the values 1, 3 and 4 steps from its middle: even powers, then odd ones."""
    below, above = values[middle - 1], values[middle + 1]
    below3, above3 = values[middle - 3], values[middle + 3]
    below4, above4 = values[middle - 4], values[middle + 4]
    _spread_powers(
        _HALF * (above + below), _HALF * (above3 + below3), _HALF * (above4 + below4), table, at
    )
    _spread_powers(
        _TWO * (above - below),
        _TWO_THIRDS * (above3 - below3),
        _HALF * (above4 - below4),
        table,
        at + COEFFICIENT,
    )


@njit(inline="always", **COMPILE)
def _spread_powers(one, three, four, table, at):  # type: ignore[no-untyped-def]
    """Every other power through values at squares of 1/16, 9/16 and 1: divided differences."""
    first = _TWO * (three - one)
    second = np.float32(16.0 / 15.0) * (np.float32(16.0 / 7.0) * (four - three) - first)
    linear = first - np.float32(0.625) * second
    constant = one - np.float32(1 / 16) * first + np.float32(9 / 256) * second
    table[at] = constant
    table[at + 2 * COEFFICIENT] = linear
    table[at + 4 * COEFFICIENT] = second


@njit(inline="always", **COMPILE)
def _cubic(values, first, table, at):  # type: ignore[no-untyped-def]
    """The piece through four values, at -1, -1/3, 1/3 and 1."""
    a, b, c, d = values[first], values[first + 1], values[first + 2], values[first + 3]
    outer, inner = _HALF * (a + d), _HALF * (b + c)
    square = np.float32(1.125) * (outer - inner)
    slope, steeper = _HALF * (d - a), np.float32(1.5) * (c - b)
    cube = np.float32(1.125) * (slope - steeper)
    table[at] = outer - square
    table[at + COEFFICIENT] = slope - cube
    table[at + 2 * COEFFICIENT] = square
    table[at + 3 * COEFFICIENT] = cube


@njit(inline="always", **COMPILE)
def glow_piece(x, y, z, sun):  # type: ignore[no-untyped-def]
    """The piece of a unit direction: its first number, where it begins, and the chord and its sign.

    The chord is the shorter of those to the sun and to the point opposite: summed from differences,
    it is exact near both.
    """
    away = x * sun[0] + y * sun[1] + z * sun[2] < _ZERO
    sign = -_ONE if away else _ONE
    dx, dy, dz = x - sign * sun[0], y - sign * sun[1], z - sign * sun[2]
    chord = math.sqrt(dx * dx + dy * dy + dz * dz)
    k = np.int32(chord * _GLOW_PIECES_A_UNIT + _HALF)
    first = k * _GLOW_STRIDE + (_AWAY if away else _NO_OFFSET)
    return first, -np.float32(k) * _GLOW_SHARE, chord, sign


@njit(inline="always", **COMPILE)
def zenith_piece(root):  # type: ignore[no-untyped-def]
    """The piece of a height, by the root of cos theta: its first number, and where it begins."""
    k = min(np.int32(root * _ZENITH_PIECES_A_UNIT), _ZENITH_LAST)
    return k * _ZENITH_STRIDE, -(np.float32(k) + _HALF) * _ZENITH_SHARE


def sky_tables(distribution: FloatArray, mean_radiance: FloatArray) -> tuple[Float32Array, ...]:
    """The flat tables of a sky, of its glow S and of Z, and H (4,) of the colours and a pad.

    `distribution` (3, 9) and `mean_radiance` (3,) are the formula's numbers.
    """
    # Pads of 0: garbage in them may be subnormal, which takes Intel's processors 16 times as long.
    glow = np.zeros(2 * AWAY, np.float32)
    zenith = np.zeros(BELOW_HORIZON + ZENITH_PIECE, np.float32)
    values = np.empty(max(_GLOW_NODES, _ZENITH_NODES), np.float32)
    numbers = fold(distribution, mean_radiance)
    fill_tables(numbers, glow, zenith, values)
    levels = np.zeros(COEFFICIENT, np.float32)
    levels[:3] = numbers[:, 10]
    return glow, zenith, levels

"""Zeros of smooth functions of one variable: all samples at once.

Between samples a function counts as unimodal: extremes are refined first, so that two zeros between
the same samples are found where the function just touches zero.
"""

from collections.abc import Callable

import numpy as np

from vrut_lite.numeric_types import FloatArray

Curve = Callable[[FloatArray], FloatArray]
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
# Halvings of a bracket, and golden sections of one: each shrinks it by a factor of 1e6 and more.
_HALVINGS, _SECTIONS = 32, 32


def crossings(curve: Curve, samples: FloatArray) -> FloatArray:
    """Zeros (k,), ascending, of a function of arrays (n,) within rising samples (n,)."""
    at = with_extremes(curve, samples)
    value = curve(at)
    positive = value > 0.0
    change = np.flatnonzero(positive[1:] != positive[:-1])
    low, high, rises = at[change], at[change + 1], positive[change + 1]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        before = (curve(middle) > 0.0) != rises
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return 0.5 * (low + high)


def with_extremes(curve: Curve, samples: FloatArray) -> FloatArray:
    """The samples and the extremes between them at which the function may touch zero, ascending."""
    value = curve(samples)
    before, here, after = value[:-2], value[1:-1], value[2:]
    # A maximum below zero or a minimum above it may reach across between the samples.
    top = (here >= before) & (here >= after) & (here <= 0.0)
    bottom = (here <= before) & (here <= after) & (here > 0.0)
    turns = np.flatnonzero(top | bottom)
    if not turns.size:
        return samples
    found = highest(curve, samples[turns], samples[turns + 2], np.where(top[turns], 1.0, -1.0))
    return np.unique(np.concatenate([samples, found]))


def highest(curve: Curve, low: FloatArray, high: FloatArray, sign: FloatArray) -> FloatArray:
    """Where sign (n,) times the function is largest between bounds (n,): golden sections."""
    for _ in range(_SECTIONS):
        width = _GOLDEN * (high - low)
        left, right = high - width, low + width
        climbs = sign * curve(left) < sign * curve(right)
        low, high = np.where(climbs, left, low), np.where(climbs, high, right)
    return 0.5 * (low + high)

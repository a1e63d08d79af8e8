"""Counted inputs from a function's whole range, and assertions about its results."""

from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.numeric_types import FloatArray

Function = Callable[..., NDArray]

# Inputs of a batch, whose arrays then take at most a few hundred megabytes.
BATCH = 1 << 16
STEP = 1e-6
# Number of a batch's steepest pairs that are examined, and of halvings for each.
STEEPEST, HALVINGS = 48, 32


class Stress:
    """Generates inputs, and counts them by function.

    Args:
        scale: factor of the number of inputs, relative to the short form.
        tally: number of inputs by function, shared by all tests.
    """

    def __init__(self, scale: float, tally: Counter[str], seed: int):
        self.scale = scale
        self.tally = tally
        self.random = np.random.default_rng(seed)

    def batches(self, function: str, short: int, most: int = BATCH) -> Iterator[int]:
        """Sizes of batches that add up to `short` times the scale, counted for the function."""
        left = max(int(short * self.scale), 1)
        self.tally[function] += left
        while left > 0:
            yield min(left, most)
            left -= most

    def within(
        self, count: int, low: float, high: float, special: ArrayLike = ()
    ) -> NDArray[np.float64]:
        """Values (count,) from `low` to `high`, both included.

        Half of them are uniform, the others at the ends and the special values or beside them, at
        distances of all orders of magnitude down to one rounding.
        """
        marks = np.concatenate([[low, high], np.ravel(np.asarray(special, dtype=float))])
        near = self.random.choice(marks, count)
        away = (high - low) * 10.0 ** self.random.uniform(-17.0, 0.0, count)
        away *= self.random.choice([-1.0, 0.0, 1.0], count, p=[0.4, 0.2, 0.4])
        even = self.random.uniform(low, high, count)
        return np.clip(np.where(self.random.random(count) < 0.5, even, near + away), low, high)

    def directions(self, count: int) -> FloatArray:
        """Unit vectors (count, 3), many of them on or near the axes and the horizontal plane."""
        up = self.within(count, -1.0, 1.0, [0.0])
        turn = self.within(count, -np.pi, np.pi, [0.0, -np.pi / 2, np.pi / 2])
        level = np.sqrt((1.0 - up) * (1.0 + up))
        return np.stack([level * np.sin(turn), up, -level * np.cos(turn)], axis=-1)


def assert_finite(values: NDArray, told: str = "") -> None:
    """Assert that there is no NaN and no infinity."""
    bad = ~np.isfinite(values)
    assert not bad.any(), f"{told} not finite at {np.argwhere(bad)[:4].tolist()}"


def assert_light(values: NDArray, told: str = "") -> None:
    """Assert finite values that are not negative."""
    assert_finite(values, told)
    assert values.min() >= 0.0, f"{told} {values.min()} at {np.argwhere(values < 0)[:4].tolist()}"


def assert_continuous(
    function: Function,
    at: FloatArray,
    *others: FloatArray,
    step: float = STEP,
    most: float = 1e-6,
    floor: float = 1e-4,
) -> None:
    """Assert no jump of `function(at, *others)` within a step of each input `at` (n,).

    `others` (n,) are constant. Where a step changes the function most it is halved repeatedly,
    towards the half with the larger change: the change of a slope vanishes, that of a jump stays.
    `most` may remain, relative to the larger of the value and `floor` of the batch's largest.
    """
    before, after = function(at, *others), function(at + step, *others)
    least = floor * max(float(np.abs(before).max()), 1e-300)
    worst = np.argsort(_change(before, after, least))[-STEEPEST:]
    before, after, low, high = before[worst], after[worst], at[worst], at[worst] + step
    others = tuple(other[worst] for other in others)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        between = function(middle, *others)
        left = _change(before, between, least) >= _change(between, after, least)
        low, high = np.where(left, low, middle), np.where(left, middle, high)
        beside = left.reshape(-1, *(1,) * (before.ndim - 1))
        before, after = np.where(beside, before, between), np.where(beside, between, after)
    change = _change(before, after, least)
    place = int(change.argmax())
    where = [float(part[place]) for part in (low, *others)]
    assert change[place] <= most, f"a jump of {change[place]:.2e} at {where}"


def _change(before: NDArray, after: NDArray, least: float) -> FloatArray:
    """Largest change (n,) over the components of (n, ...), relative."""
    size = np.maximum(np.maximum(np.abs(before), np.abs(after)), least)
    change = np.abs(after.astype(float) - before) / size
    return change.reshape(len(change), -1).max(axis=1)


def assert_rising(values: NDArray, slack: float = 0.0) -> None:
    """Assert that values never fall along the first axis, except by rounding."""
    falls = (values[:-1] - values[1:]).max()
    assert falls <= slack, f"falls by {falls}"


def assert_same_on_threads(function: Callable[..., object], *arguments: object) -> None:
    """Assert that two threads at once give the same bits as one alone."""
    alone = _arrays(function(*arguments))
    with ThreadPoolExecutor(2) as pool:
        together = [pool.submit(function, *arguments) for _ in range(2)]
        for future in together:
            for one, other in zip(alone, _arrays(future.result()), strict=True):
                np.testing.assert_array_equal(one, other)


def _arrays(result: object) -> list[NDArray]:
    return (
        [np.asarray(part) for part in result] if isinstance(result, tuple) else [np.asarray(result)]
    )

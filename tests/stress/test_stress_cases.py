"""The suite's assertions find planted faults, and accept steep slopes."""

import numpy as np
import pytest
from stress_cases import assert_continuous, assert_light, assert_rising, assert_same_on_threads


def test_a_planted_jump_is_found(stress):
    """A jump of 1e-5 of the value is found; the infinite slope of a root is accepted."""
    at = stress.within(20_000, 0.0, 1.0, [0.3])
    with pytest.raises(AssertionError, match=r"a jump of 1\.0"):
        assert_continuous(lambda x: 1.0 + 1e-5 * (x > 0.3), at)
    assert_continuous(lambda x: np.sqrt(np.abs(x - 0.3)) + np.sin(50.0 * x), at)


def test_inputs_hold_ends_and_neighbours(stress):
    """Inputs contain both ends, the special value, and values a few roundings from it."""
    values = stress.within(20_000, -1.0, 1.0, [0.0])
    assert values.min() == -1.0
    assert values.max() == 1.0
    assert (values == 0.0).sum() > 500
    assert ((values != 0.0) & (np.abs(values) < 1e-15)).sum() > 100
    assert ((values < 1.0) & (values > 1.0 - 1e-15)).sum() > 10
    assert np.linalg.norm(stress.directions(1000), axis=1) == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1e-300])
def test_negative_and_infinite_light_is_found(bad):
    """A single NaN, infinity or negative number is found."""
    values = np.ones((50, 3))
    assert_light(values)
    values[17, 1] = bad
    with pytest.raises(AssertionError, match="17, 1"):
        assert_light(values, "planted")


def test_a_fall_and_a_race_are_found():
    """A value that falls, and a function that shares a buffer between threads, are found."""
    assert_rising(np.array([0.0, 1.0, 1.0, 2.0]))
    with pytest.raises(AssertionError, match="falls"):
        assert_rising(np.array([0.0, 1.0, 1.0 - 1e-15]))
    calls = []

    def shares():
        calls.append(None)
        return np.array([len(calls)])

    with pytest.raises(AssertionError):
        assert_same_on_threads(shares)

"""The suite's own eyes: planted faults are seen, steep slopes are not taken for faults."""

import numpy as np
import pytest
from stress_cases import assert_continuous, assert_light, assert_rising, assert_same_on_threads


def test_a_planted_jump_is_found(stress):
    """One of 1e-5 of the value, at a special place; a root's infinite slope is none."""
    at = stress.within(20_000, 0.0, 1.0, [0.3])
    with pytest.raises(AssertionError, match=r"a jump of 1\.0"):
        assert_continuous(lambda x: 1.0 + 1e-5 * (x > 0.3), at)
    assert_continuous(lambda x: np.sqrt(np.abs(x - 0.3)) + np.sin(50.0 * x), at)


def test_inputs_hold_ends_and_neighbours(stress):
    """Both ends, the special value itself, and values a few roundings from it."""
    values = stress.within(20_000, -1.0, 1.0, [0.0])
    assert values.min() == -1.0
    assert values.max() == 1.0
    assert (values == 0.0).sum() > 500
    assert ((values != 0.0) & (np.abs(values) < 1e-15)).sum() > 100
    assert ((values < 1.0) & (values > 1.0 - 1e-15)).sum() > 10
    assert np.linalg.norm(stress.directions(1000), axis=1) == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1e-300])
def test_what_is_no_light_is_found(bad):
    """One number among many, a negative one of any size."""
    values = np.ones((50, 3))
    assert_light(values)
    values[17, 1] = bad
    with pytest.raises(AssertionError, match="17, 1"):
        assert_light(values, "planted")


def test_a_fall_and_a_race_are_found():
    """A value that falls by a rounding too much; a function that shares a buffer."""
    assert_rising(np.array([0.0, 1.0, 1.0, 2.0]))
    with pytest.raises(AssertionError, match="falls"):
        assert_rising(np.array([0.0, 1.0, 1.0 - 1e-15]))
    calls = []

    def shares():
        calls.append(None)
        return np.array([len(calls)])

    with pytest.raises(AssertionError):
        assert_same_on_threads(shares)

"""What counts as slower and as less accurate, and what does not."""

import msgspec
import pytest
from bench_samples import MACHINE, measured, run_of
from hypothesis import given, settings
from hypothesis import strategies as st

from vrut_lite.errors import UserError
from vrut_lite_lab.bench.compare import check_comparable, compare, slower_paths
from vrut_lite_lab.bench.front import pareto_front

BEFORE = measured("fast, 4", [0.010, 0.011, 0.012])


def test_the_same_run_is_not_worse() -> None:
    """A run against itself has nothing to tell."""
    run = run_of(BEFORE)
    assert compare(run, run) == ([], [])


@pytest.mark.parametrize(
    ("then_s", "now_s", "slower"),
    [
        ([0.010, 0.011, 0.013], [0.020, 0.021, 0.022], True),
        # One round as fast as the slowest of before: that may be noise.
        ([0.010, 0.011, 0.013], [0.020, 0.0125, 0.022], False),
        # All slower than all, but by less than a tenth of the least.
        ([0.010, 0.0102, 0.0105], [0.0109, 0.0109, 0.0109], False),
        ([0.010, 0.011, 0.013], [0.005, 0.006, 0.007], False),
    ],
)
def test_slower_is_each_round_and_a_tenth(then_s, now_s, slower: bool) -> None:
    """The stated rule: each round now against each then, and more than a tenth of the least."""
    found = compare(run_of(measured("fast, 4", then_s)), run_of(measured("fast, 4", now_s)))
    assert bool(found.worse) == slower


def test_a_slower_machine_is_counted_out() -> None:
    """Twice the time on a machine whose fixed piece of work takes twice as long is no loss."""
    now = measured("fast, 4", [0.020, 0.021, 0.022])
    slow = msgspec.structs.replace(MACHINE, pace_s=2 * MACHINE.pace_s)
    assert slower_paths(run_of(BEFORE), run_of(now, machine=slow)) == []
    assert slower_paths(run_of(BEFORE), run_of(now)) == [("sky", "fast, 4")]


def test_once_timed_is_slower_from_half_as_much_again() -> None:
    """A single round knows no noise: 1.4 times as long is none, 1.6 times is."""
    before = run_of(measured("pipeline", [10.0]))
    assert not compare(before, run_of(measured("pipeline", [14.0]))).worse
    (sentence,) = compare(before, run_of(measured("pipeline", [16.0]))).worse
    assert "pipeline: 1.60 times slower" in sentence


def test_less_accurate_names_the_condition() -> None:
    """The mean's or the 99th percentile's growth by a twentieth, and what grew most."""
    worse = measured("fast, 4", BEFORE.rounds_s, p99=0.02)
    (sentence,) = compare(run_of(BEFORE), run_of(worse)).worse
    assert "99th percentile of the error 0.0" in sentence
    assert "sun" in sentence
    assert not compare(run_of(BEFORE), run_of(measured("fast, 4", [0.01], p99=0.0104))).worse


def test_rounding_is_no_loss() -> None:
    """Errors of 1e-15 double by another order of summation, which is not reported as worse."""
    exact = measured("twin", [0.01], p99=1e-15, mean=1e-16)
    assert not compare(run_of(exact), run_of(measured("twin", [0.01], 2e-15, 2e-16))).worse


def test_another_processor_has_other_times() -> None:
    """Then times are left alone and that is said; errors are compared all the same."""
    other = msgspec.structs.replace(MACHINE, processor="another")
    slow = measured("fast, 4", [1.0, 1.0, 1.0], p99=0.5)
    found = compare(run_of(BEFORE), run_of(slow, machine=other))
    assert len(found.worse) == 1
    assert "error" in found.worse[0]
    assert "processors" in found.remarks[0]


def test_a_path_that_is_gone_is_told() -> None:
    """A removed path is reported, and counts as no regression."""
    found = compare(run_of(BEFORE, measured("old", [1.0])), run_of(BEFORE))
    assert found.worse == []
    assert found.remarks == ["sky, old: no longer measured"]


def test_runs_must_be_alike() -> None:
    """The quick form has other truths; other computations have nothing in common."""
    with pytest.raises(UserError, match="measured with --quick"):
        check_comparable(run_of(BEFORE), False, ["sun"])
    with pytest.raises(UserError, match="are of sun alone"):
        check_comparable(run_of(BEFORE), True, ["tables"])
    check_comparable(run_of(BEFORE), True, ["tables", "sun"])


POINTS = st.lists(st.tuples(st.floats(0.1, 9.0), st.floats(0.1, 9.0)), min_size=1, max_size=12)


@given(POINTS)
@settings(deadline=None)
def test_the_front_holds_unbeaten_paths(points: list[tuple[float, float]]) -> None:
    """The definition: no point is at least as good in both and better in one than one of the front,
    and every other point is beaten, or equalled, by one of the front."""
    seconds, errors = (list(axis) for axis in zip(*points, strict=True))
    front = pareto_front(seconds, errors)

    def beats(a: int, b: int) -> bool:
        no_worse = seconds[a] <= seconds[b] and errors[a] <= errors[b]
        return no_worse and points[a] != points[b]

    everyone = range(len(points))
    assert not any(beats(a, b) for b in front for a in everyone)
    assert all(any(beats(f, b) or points[f] == points[b] for f in front) for b in everyone)
    assert [seconds[i] for i in front] == sorted(seconds[i] for i in front)

"""Compares two runs: finds paths that became slower or less accurate by more than the noise.

**Slower.** Rounds are divided by the pace that the machine kept in their run. A path is slower if
each of its rounds now is slower than each of its rounds then, and the least by more than a tenth:
of five and five rounds of equal speed one pair in 252 is so by chance. What was timed once,
because a call takes seconds, is slower from one and a half times as long. Other work on the
machine slows many rounds in a row: the caller times again, later, what looks slower
(`slower_paths`). Run times are compared only between runs on one kind of processor.

**Less accurate.** Errors hardly depend on chance: a path is less accurate if under any
condition the mean or the 99th percentile has grown by more than a twentieth, and by more than
rounding (1e-12).
"""

from typing import NamedTuple

from vrut_lite.errors import UserError
from vrut_lite_lab.bench.results import MeasuredPath, Results

SLOWER, SLOWER_ONCE = 1.1, 1.5
LESS_ACCURATE, ROUNDING = 1.05, 1e-12
Key = tuple[str, str]


class BenchComparison(NamedTuple):
    """Sentences about worse paths, and about paths that cannot be compared."""

    worse: list[str]
    remarks: list[str]


def check_comparable(old: Results, quick: bool, kinds: list[str]) -> None:
    """Check, before anything is measured, that it can be compared with the old results.

    Raises:
        UserError: one is of the quick form and the other is not, or they share nothing.
    """
    if old.quick != quick:
        which = "with" if old.quick else "without"
        raise UserError(f"the old results were measured {which} --quick: measure likewise")
    if not set(kinds) & set(old.kinds):
        raise UserError(
            f"the old results are of {', '.join(old.kinds)} alone: measure some of these"
        )


def compare(old: Results, new: Results) -> BenchComparison:
    """The worse paths of the new results."""
    before = _by_key(old)
    pairs = [(before[key], now) for key, now in _by_key(new).items() if key in before]
    worse = [_slower(old, new, key) for key in slower_paths(old, new)]
    worse += [sentence for pair in pairs if (sentence := less_accurate(*pair))]
    remarks = []
    if not _same_machine(old, new):
        remarks.append("run times are not compared: the processors or their numbers differ")
    groups = {path.group for path in new.paths}
    gone = sorted(before.keys() - _by_key(new).keys())
    remarks += [f"{group}, {name}: no longer measured" for group, name in gone if group in groups]
    return BenchComparison(worse, remarks)


def slower_paths(old: Results, new: Results) -> list[Key]:
    """Group and name of slower paths."""
    if not _same_machine(old, new):
        return []
    before = _by_key(old)
    paces = old.machine.pace_s, new.machine.pace_s
    return [
        key
        for key, now in _by_key(new).items()
        if key in before and is_slower(before[key], now, *paces)
    ]


def is_slower(then: MeasuredPath, now: MeasuredPath, pace_then_s: float, pace_now_s: float) -> bool:
    """Whether a path is slower by the rule above."""
    if then.clock != now.clock:
        return False
    before = [seconds / pace_then_s for seconds in then.rounds_s]
    after = [seconds / pace_now_s for seconds in now.rounds_s]
    ratio = min(after) / min(before)
    if min(len(before), len(after)) == 1:
        return ratio > SLOWER_ONCE
    return ratio > SLOWER and min(after) > max(before)


def less_accurate(then: MeasuredPath, now: MeasuredPath) -> str:
    """A sentence about the condition under which errors grew most, or nothing."""
    grown = [
        (getattr(after, size) / max(getattr(before, size), ROUNDING), name, size)
        for name, after in now.errors.items()
        if (before := then.errors.get(name)) is not None
        for size in ("mean", "p99")
        if getattr(after, size) > LESS_ACCURATE * getattr(before, size) + ROUNDING
    ]
    if not grown:
        return ""
    _, name, size = max(grown)
    was, is_now = getattr(then.errors[name], size), getattr(now.errors[name], size)
    words = "mean error" if size == "mean" else "99th percentile of the error"
    return f"{now.group}, {now.name}: {words} {was:.3g} then and {is_now:.3g} now ({name})"


def _slower(old: Results, new: Results, key: Key) -> str:
    then, now = _by_key(old)[key], _by_key(new)[key]
    ratio = now.seconds / then.seconds * old.machine.pace_s / new.machine.pace_s
    return (
        f"{now.group}, {now.name}: {ratio:.2f} times slower, "
        f"{1e3 * then.seconds:.3g} ms then and {1e3 * now.seconds:.3g} ms now"
    )


def _same_machine(old: Results, new: Results) -> bool:
    a, b = old.machine, new.machine
    return (a.processor, a.cores) == (b.processor, b.cores)


def _by_key(results: Results) -> dict[Key, MeasuredPath]:
    return {(path.group, path.name): path for path in results.paths}

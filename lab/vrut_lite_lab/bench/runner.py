"""Times paths in turns over some rounds, which other work on the machine disturbs least."""

import math
from collections.abc import Callable, Iterable
from itertools import groupby
from typing import NamedTuple

import numpy as np

from vrut_lite import compiled_code
from vrut_lite.errors import ModuleFailed
from vrut_lite_lab.bench.bench_path import CPU_TIME, BenchPath, Group, Spent, Work
from vrut_lite_lab.bench.results import Errors, MeasuredPath

Tell = Callable[[str], None]
Refuse = Callable[[str, str], None]
# Longer calls are timed once only, in the call whose result is judged.
_ONCE_FROM_S = 2.5
# Longer first calls are not repeated, unless they compiled.
_AGAIN_TO_S = 20.0
# A path may compile in its first calls: a moving picture has a predecessor from the second on.
_MOST_COMPILING = 5
_MOST_CALLS = 40


class Effort(NamedTuple):
    """How many rounds, and how many seconds for all rounds of a path."""

    rounds: int
    budget_s: float


FULL, QUICK = Effort(5, 0.5), Effort(3, 0.12)


class _Running(NamedTuple):
    """A path that is being timed; `first_s` is the time of its first call."""

    path: BenchPath
    work: Work
    first_s: float
    first_wall_s: float
    errors: dict[str, Errors]
    rounds_s: list[float]
    walls_s: list[float]


class _FalseFigure(Exception):
    """A figure that is not the time of the path's work, and why."""


def raise_refused(name: str, reason: str) -> None:
    """Raise ModuleFailed for a path whose figure would be false."""
    raise ModuleFailed(f"{name}: {reason}")


def measure_group(
    group: Group, effort: Effort, tell: Tell, refuse: Refuse = raise_refused
) -> list[MeasuredPath]:
    """Measure every path of a group.

    Args:
        group: of paths.
        effort: of each.
        tell: called with each name before it is measured.
        refuse: called with the name of a path and the reason, where a call skipped the work or
            compiled in every call; such a path has no figure.
    """
    found = []
    for _, batch in groupby(group.paths, key=lambda path: path.batch):
        found += _measure_batch(group, batch, effort, tell, refuse)
    return found


def _measure_batch(
    group: Group, paths: Iterable[BenchPath], effort: Effort, tell: Tell, refuse: Refuse
) -> list[MeasuredPath]:
    running: list[_Running] = []
    for path in paths:
        try:
            running.append(_start(path, group.name, tell))
        except _FalseFigure as error:
            refuse(f"{group.name}: {path.name}", str(error))
    turns = [e for e in running if e.first_s < _ONCE_FROM_S and not e.path.once]
    calls = [_calls(each, effort) for each in turns]
    for _ in range(effort.rounds if turns else 0):
        for each, count in zip(turns, calls, strict=True):
            if each in running:
                try:
                    _time_round(each, count)
                except _FalseFigure as error:
                    refuse(f"{group.name}: {each.path.name}", str(error))
                    running.remove(each)
    for each in running:
        if not each.rounds_s:
            each.rounds_s.append(each.first_s)
            each.walls_s.append(each.first_wall_s)
    return [_measured(group, each) for each in running]


def _start(path: BenchPath, group: str, tell: Tell) -> _Running:
    """Run a path until a call compiles nothing, compute its errors, and time a second call."""
    tell(f"{group}: {path.name}")
    work = path.prepare()
    first, compiled = _call(path, work)
    errors = {} if path.error is None else path.error(first.result)
    spent = first
    if not path.once and first.seconds < _AGAIN_TO_S and not compiled:
        again, _ = _call(path, work)
        spent = min(first, again, key=lambda one: one.seconds)
    elif compiled:
        spent = _without_compiling(path, work)
    return _Running(path, work, spent.seconds, spent.wall_s, errors, [], [])


def _call(path: BenchPath, work: Work) -> tuple[Spent, bool]:
    """One call, and whether it compiled.

    Raises:
        _FalseFigure: it did not do the work.
    """
    done = path.done(work) if path.done is not None else 0
    compiled = compiled_code.compilations
    spent = path.clock.time(work)
    if path.done is not None and path.done(work) <= done:
        raise _FalseFigure("a timed call skipped the work")
    return spent, compiled_code.compilations > compiled


def _without_compiling(path: BenchPath, work: Work) -> Spent:
    for _ in range(_MOST_COMPILING):
        spent, compiled = _call(path, work)
        if not compiled:
            return spent
    raise _FalseFigure(f"{_MOST_COMPILING} calls in a row compiled kernels")


def _calls(running: _Running, effort: Effort) -> int:
    # By wall time: the seconds of the clock may be those of one pass of a frame.
    each_s = effort.budget_s / effort.rounds
    return max(1, min(_MOST_CALLS, math.floor(each_s / max(running.first_wall_s, 1e-9))))


def _time_round(running: _Running, calls: int) -> None:
    """Some calls in a row, so that caches are filled by this path and not by another."""
    path, work = running.path, running.work
    spent = [
        _without_compiling(path, work) if compiled else one
        for one, compiled in (_call(path, work) for _ in range(calls))
    ]
    running.rounds_s.append(min(one.seconds for one in spent))
    running.walls_s.append(min(one.wall_s for one in spent))


def _measured(group: Group, running: _Running) -> MeasuredPath:
    path = running.path
    return MeasuredPath(
        group=group.name,
        name=path.name,
        family=path.family,
        device=path.device,
        parameters=dict(path.parameters),
        clock=path.clock.name,
        rounds_s=[seconds / path.units for seconds in running.rounds_s],
        wall_s=min(running.walls_s) / path.units,
        errors=running.errors,
    )


_NUMBERS = np.linspace(0.0, 1.0, 50_000)


def pace_s() -> float:
    """The least CPU time of a fixed piece of work, some of it numpy's, some the interpreter's.

    Times of two runs are divided by it, so that a slower machine does not count.
    """
    return min(CPU_TIME.time(_fixed_work).seconds for _ in range(7))


def _fixed_work() -> float:
    return float(np.exp(_NUMBERS).sum()) + sum(math.sqrt(k) for k in range(5_000))

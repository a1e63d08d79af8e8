"""Times paths in turns over some rounds, which other work on the machine disturbs least."""

import math
from collections.abc import Callable, Iterable
from itertools import groupby
from typing import NamedTuple

import numpy as np

from vrut_lite_bench.bench_path import CPU_TIME, BenchPath, Group, Work
from vrut_lite_bench.results import Errors, Measured

Tell = Callable[[str], None]
# Longer calls are timed once only, in the call whose result is judged.
_ONCE_FROM_S = 2.5
# A first call of so long may have been compiling.
_AGAIN_TO_S = 20.0
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


def measure_group(group: Group, effort: Effort, tell: Tell) -> list[Measured]:
    """Measure every path of a group; `tell` is called with each name before it is measured."""
    found = []
    for _, batch in groupby(group.paths, key=lambda path: path.batch):
        found += _measure_batch(group, batch, effort, tell)
    return found


def _measure_batch(
    group: Group, paths: Iterable[BenchPath], effort: Effort, tell: Tell
) -> list[Measured]:
    running = [_start(path, group.name, tell) for path in paths]
    turns = [e for e in running if e.first_s < _ONCE_FROM_S and not e.path.once]
    calls = [_calls(each, effort) for each in turns]
    for _ in range(effort.rounds if turns else 0):
        for each, count in zip(turns, calls, strict=True):
            _time_round(each, count)
    for each in running:
        if not each.rounds_s:
            each.rounds_s.append(each.first_s)
            each.walls_s.append(each.first_wall_s)
    return [_measured(group, each) for each in running]


def _start(path: BenchPath, group: str, tell: Tell) -> _Running:
    """Run a path once, which may compile; compute its errors, and time a second call."""
    tell(f"{group}: {path.name}")
    work = path.prepare()
    first = path.clock.time(work)
    errors = {} if path.error is None else path.error(first.result)
    spent = first
    if not path.once and first.seconds < _AGAIN_TO_S:
        again = path.clock.time(work)
        spent = min(first, again, key=lambda one: one.seconds)
    return _Running(path, work, spent.seconds, spent.wall_s, errors, [], [])


def _calls(running: _Running, effort: Effort) -> int:
    # By wall time: the seconds of the clock may be those of one pass of a frame.
    each_s = effort.budget_s / effort.rounds
    return max(1, min(_MOST_CALLS, math.floor(each_s / max(running.first_wall_s, 1e-9))))


def _time_round(running: _Running, calls: int) -> None:
    """Some calls in a row, so that caches are filled by this path and not by another."""
    spent = [running.path.clock.time(running.work)[1:] for _ in range(calls)]
    running.rounds_s.append(min(seconds for seconds, _ in spent))
    running.walls_s.append(min(wall for _, wall in spent))


def _measured(group: Group, running: _Running) -> Measured:
    path = running.path
    return Measured(
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

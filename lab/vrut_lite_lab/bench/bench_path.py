"""A benchmark path is one way to compute something; a group holds the ways to compute the same."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite_lab.bench.results import Errors

Work = Callable[[], Any]
Parameter = int | float | str
_FLOOR = 1e-3
PICTURE_NORM = (
    "difference over the larger of the value and a thousandth of the picture's maximum, "
    "each channel; 99th percentile over the picture"
)


class Spent(NamedTuple):
    """The result of one call of some work, and the seconds that it took."""

    result: Any
    seconds: float
    wall_s: float


def relative_errors(found: NDArray[Any], exact: NDArray[Any]) -> Errors:
    """Errors relative to the larger of each value and a thousandth of the picture's maximum."""
    right = np.asarray(exact, dtype=float)
    least = _FLOOR * float(right.max())
    return sizes_of(np.abs(np.asarray(found, dtype=float) - right) / np.maximum(right, least))


def sizes_of(errors: NDArray[Any]) -> Errors:
    """Mean, 99th percentile and largest."""
    return Errors(float(errors.mean()), float(np.quantile(errors, 0.99)), float(errors.max()))


class WorkClock(NamedTuple):
    """A clock: its name in words, and the function that times work."""

    name: str
    time: Callable[[Work], Spent]


def cpu_spent(work: Work) -> Spent:
    """Work timed by the CPU time of the process, all its threads."""
    wall_s, seconds = time.perf_counter(), time.process_time()
    result = work()
    return Spent(result, time.process_time() - seconds, time.perf_counter() - wall_s)


def wall_spent(work: Work) -> Spent:
    """Work timed by the clock on the wall."""
    start = time.perf_counter()
    result = work()
    spent = time.perf_counter() - start
    return Spent(result, spent, spent)


CPU_TIME = WorkClock("CPU time of the process", cpu_spent)
WALL_TIME = WorkClock("wall time", wall_spent)


@dataclass(frozen=True)
class BenchPath:
    """One way to compute something.

    Attributes:
        name: unique in its group.
        family: the paths that differ by effort alone; a plot draws them as one line.
        parameters: the path's parameters by name.
        prepare: does the set-up and returns the work to time, which computes all conditions one
            after another.
        error: errors by the conditions' names, of what the work returned; None without a twin.
        units: number of things that the work makes; times are per unit.
        batch: paths of a group with the same batch take turns while they are timed.
        clock: times the work.
        once: the clock does all rounds itself.
        done: given the prepared work, the amount of it done so far; each call must raise it, or
            the path is refused: it timed work that was skipped.
    """

    name: str
    family: str
    prepare: Callable[[], Work]
    error: Callable[[Any], dict[str, Errors]] | None
    parameters: dict[str, Parameter] = field(default_factory=dict)
    units: int = 1
    batch: str = ""
    clock: WorkClock = CPU_TIME
    device: str = "CPU"
    once: bool = False
    done: Callable[[Work], int] | None = None


@dataclass(frozen=True)
class Group:
    """Ways to compute the same thing; their run times and errors make one plot.

    Attributes:
        name: in results and files.
        title: of the plot.
        unit: the unit of work of a time.
        norm: the reference of relative errors.
        truth: the reference of the errors.
        paths: in the order of measuring.
        front_of: only paths whose names end so are compared for the front.
        left_out: paths that cannot be measured on this machine, and why.
    """

    name: str
    title: str
    unit: str
    norm: str
    truth: str
    paths: tuple[BenchPath, ...]
    front_of: str = ""
    left_out: dict[str, str] = field(default_factory=dict)

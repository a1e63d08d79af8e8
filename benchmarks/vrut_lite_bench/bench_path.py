"""What is measured: a benchmark path is one way to compute something; a group holds rivals."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Work = Callable[[], Any]
Parameter = int | float | str
_FLOOR = 1e-3
PICTURE_NORM = (
    "difference over the larger of the value and a thousandth of the picture's maximum, "
    "each channel; 99th percentile over the picture"
)


class Spent(NamedTuple):
    """What one call of some work gave, and the seconds that it took."""

    result: Any
    seconds: float
    wall_s: float


class Errors(NamedTuple):
    """Of a picture's or a grid's relative errors: mean, 99th percentile, largest."""

    mean: float
    p99: float
    largest: float


def relative_errors(found: NDArray[Any], exact: NDArray[Any]) -> Errors:
    """Errors relative to the larger of each value and a thousandth of the picture's maximum."""
    right = np.asarray(exact, dtype=float)
    least = _FLOOR * float(right.max())
    return sizes_of(np.abs(np.asarray(found, dtype=float) - right) / np.maximum(right, least))


def sizes_of(errors: NDArray[Any]) -> Errors:
    """Mean, 99th percentile and largest."""
    return Errors(float(errors.mean()), float(np.quantile(errors, 0.99)), float(errors.max()))


class Clock(NamedTuple):
    """How seconds are counted, in words, and what counts them."""

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


CPU_TIME = Clock("CPU time of the process", cpu_spent)
WALL_TIME = Clock("wall time", wall_spent)


@dataclass(frozen=True)
class BenchPath:
    """One way to compute something.

    Attributes:
        name: unique in its group.
        family: the paths that differ by effort alone; a plot draws them as one line.
        parameters: what the path was asked for, by name.
        prepare: does what is done once, and returns the work to be timed: all conditions, one
            after another.
        error: from what the work returned to errors by the conditions' names; none where
            nothing can err.
        units: what the work makes: time is told per unit.
        batch: paths of a group that share it take turns while they are timed.
        clock: by which it is timed.
        once: its clock has done all rounds itself.
    """

    name: str
    family: str
    prepare: Callable[[], Work]
    error: Callable[[Any], dict[str, Errors]] | None
    parameters: dict[str, Parameter] = field(default_factory=dict)
    units: int = 1
    batch: str = ""
    clock: Clock = CPU_TIME
    device: str = "CPU"
    once: bool = False


@dataclass(frozen=True)
class Group:
    """Ways to compute the same, whose run times and errors make one plot.

    Attributes:
        name: how it is asked for.
        title: of the plot.
        unit: what a time is the time of.
        norm: what an error is relative to.
        truth: what errors are counted from.
        paths: its ways.
        front_of: those whose names end so compete for the front; others make another thing.
        left_out: ways that this machine cannot go, and why.
    """

    name: str
    title: str
    unit: str
    norm: str
    truth: str
    paths: tuple[BenchPath, ...]
    front_of: str = ""
    left_out: dict[str, str] = field(default_factory=dict)

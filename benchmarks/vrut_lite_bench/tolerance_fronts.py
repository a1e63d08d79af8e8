"""Fronts of error against work, from which modules choose for a tolerance, and what they keep.

    export OPENBLAS_NUM_THREADS=1
    python -m vrut_lite_bench.tolerance_fronts dynamic_skylight --write
    python -m vrut_lite_bench.tolerance_fronts bruneton_sky --write --keep FOLDER

With `--write` one set of random pictures makes the fronts, in the module's data folder. Another,
drawn from another seed, is made at each tolerance and held against the exact twin. A picture is
within a tolerance if 99 % of its directions are, those darker than a thousandth of its brightest
being measured by that. The Bruneton sky's converged twins take half a minute of CPU for each
fifteen pictures; `--keep` names a folder in which they are found again.
"""

import argparse
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np

from vrut_lite.daylight.tolerance import Measured, Point, read_fronts

TOLERANCES = (0.3, 0.1, 0.03, 0.01, 0.003, 0.001)
# A solution to 1 % takes seconds, and twenty of them a while.
BRUNETON_TOLERANCES = (0.3, 0.1, 0.05, 0.03, 0.02, 0.01)
MEASURING_SEED, CHECKING_SEED = 1, 2
Fronts = dict[str, list[Point[int | str]]]
# Errors of the random pictures of a seed at a tolerance.
Errors = Callable[[float], list[float]]


class Task(NamedTuple):
    """How a module is measured: its fronts, where they belong, and errors of other pictures at
    some tolerances."""

    fronts: Callable[[], Fronts]
    file: Path
    errors: Errors
    pictures: int
    tolerances: tuple[float, ...] = TOLERANCES


class Kept(NamedTuple):
    """How many of so many pictures stay within a tolerance, and what 99 % of them stay within."""

    tolerance: float
    within: int
    pictures: int
    error: float


def kept(errors: Errors, tolerance: float) -> Kept:
    """The share of pictures that keep a tolerance."""
    found = np.array(errors(tolerance))
    within = int((found <= tolerance).sum())
    return Kept(tolerance, within, len(found), float(np.quantile(found, 0.99)))


def write(task: Task, module: str, fronts: Fronts) -> None:
    """Leave the fronts where the module reads them."""
    measured = Measured(module, task.pictures, MEASURING_SEED, fronts)
    text = msgspec.json.format(msgspec.json.encode(measured), indent=1)
    task.file.write_bytes(text + b"\n")


def front_lines(fronts: Fronts) -> Iterator[str]:
    """A Markdown table of the fronts."""
    yield "| knob | choice | error, 99 % of directions in 99 % of pictures | work | CPU ms |"
    yield "|---|---|---:|---:|---:|"
    for knob, front in fronts.items():
        for p in front:
            yield f"| {knob} | {p.choice} | {p.error:.3%} | {p.work:.3g} | {p.cpu_ms:.3g} |"


def kept_lines(task: Task) -> Iterator[str]:
    """A Markdown table of what is kept."""
    yield "| tolerance | pictures within | share | 99 % of pictures within |"
    yield "|---:|---:|---:|---:|"
    for tolerance in task.tolerances:
        one = kept(task.errors, tolerance)
        share = one.within / one.pictures
        yield f"| {tolerance:g} | {one.within} of {one.pictures} | {share:.1%} | {one.error:.3%} |"


def skylight_task(pictures: int, _keep: Path | None) -> Task:
    """DynamicSkyLight's."""
    from dynamic_skylight.tolerance import FRONTS, quality_for

    from vrut_lite_bench.tolerance_skylight import fronts, picture_error, random_hours

    def errors(tolerance: float) -> list[float]:
        hours = random_hours(pictures, CHECKING_SEED)
        return [picture_error(hour, quality_for(tolerance)) for hour in hours]

    hours = random_hours(pictures, MEASURING_SEED)
    return Task(lambda: fronts(hours), FRONTS, errors, pictures)


def bruneton_task(pictures: int, keep: Path | None) -> Task:
    """The Bruneton sky's."""
    from bruneton_sky.tolerance import FRONTS, quality_for

    from vrut_lite_bench.tolerance_bruneton import fronts, picture_errors
    from vrut_lite_bench.tolerance_bruneton_truth import VIEWS, two_sets

    if keep is not None:
        keep.mkdir(parents=True, exist_ok=True)
    count = -(-pictures // VIEWS)
    measured, checked = two_sets(count, (MEASURING_SEED, CHECKING_SEED))

    def errors(tolerance: float) -> list[float]:
        return picture_errors(checked, quality_for(tolerance), keep)

    return Task(lambda: fronts(measured, keep), FRONTS, errors, count * VIEWS, BRUNETON_TOLERANCES)


TASKS = {"dynamic_skylight": skylight_task, "bruneton_sky": bruneton_task}


def main() -> None:
    """Print one module's fronts, measured anew if asked; then what it keeps."""
    parser = argparse.ArgumentParser(description="Fronts for the tolerance, and what it keeps.")
    parser.add_argument("module", choices=list(TASKS))
    parser.add_argument("--pictures", type=int, default=200, help="of each of the two sets")
    parser.add_argument("--write", action="store_true", help="measure the fronts anew")
    parser.add_argument("--keep", type=Path, help="a folder that keeps what takes long to compute")
    given = parser.parse_args()
    task = TASKS[given.module](given.pictures, given.keep)
    if given.write:
        write(task, given.module, task.fronts())
    for lines in (front_lines(read_fronts(task.file).fronts), kept_lines(task)):
        for line in lines:
            print(line, flush=True)
        print()


if __name__ == "__main__":
    main()

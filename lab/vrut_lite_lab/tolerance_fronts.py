"""Measures the fronts of error against work from which a module chooses for a tolerance.

    export OPENBLAS_NUM_THREADS=1
    python -m vrut_lite_lab.tolerance_fronts dynamic_skylight --write
    python -m vrut_lite_lab.tolerance_fronts bruneton_sky --pictures 90 --write --keep FOLDER

Any installed module, or one in a folder named by --modules, that declares its knobs
(`vrut_lite_lab.tolerance.knobs`) can be measured. With --write one set of random pictures
makes the fronts in the module's data file. A second set is made at each tolerance and compared with
its truth. The Bruneton sky's truth takes half a minute of CPU for fifteen pictures: --keep names a
folder in which truths are stored and found again.
"""

import argparse
import hashlib
import sys
import time
from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from vrut_lite.discovery import discover
from vrut_lite.errors import UserError
from vrut_lite.kernel.module import Module
from vrut_lite.messages.tolerance import MeasuredFronts, Point, read_fronts
from vrut_lite_lab.tolerance.knobs import MOST, ToleranceKnobs, Truth

_SEED, _ROUNDS = 1, 3
Truths = Callable[[Any], Truth]


def knobs_of(module: type[Module]) -> ToleranceKnobs[Any] | None:
    """A module's `KNOBS`: of `tolerance`, of `tolerance_knobs` beside its file, or of that file."""
    home = sys.modules[module.__module__]
    for name in (
        f"vrut_lite_lab.tolerance.{module.manifest.name}",
        f"{home.__package__}.tolerance_knobs",
    ):
        if home.__package__ and find_spec(name) is not None:
            home = import_module(name)
            break
    declared = getattr(home, "KNOBS", None)
    return declared if isinstance(declared, ToleranceKnobs) else None


def declared_knobs(folders: tuple[Path, ...] = ()) -> dict[str, ToleranceKnobs[Any]]:
    """The knobs of all modules that declare some, by the modules' names."""
    modules, _ = discover(folders)
    found = {module.manifest.name: knobs_of(module) for module in modules}
    return {name: knobs for name, knobs in found.items() if knobs is not None}


def kept_truths(knobs: ToleranceKnobs[Any], folder: Path | None) -> Truths:
    """The module's truth, looked for in a folder first and stored there."""
    if folder is None:
        return knobs.truth
    folder.mkdir(parents=True, exist_ok=True)

    def truth(sample: Any) -> Truth:
        file = folder / f"{hashlib.sha256(repr(sample).encode()).hexdigest()[:24]}.npz"
        if not file.exists():
            arrays: dict[str, Any] = {str(n): one for n, one in enumerate(knobs.truth(sample))}
            np.savez(file, **arrays)
        with np.load(file) as stored:
            return [stored[str(n)] for n in range(len(stored.files))]

    return truth


def measure(
    name: str, knobs: ToleranceKnobs[Any], samples: list[Any], truths: Truths
) -> MeasuredFronts:
    """Fronts: of each choice the error that 99 % of the pictures stay within, work and CPU time."""
    errors: dict[str, list[Any]] = {knob: [] for knob in knobs.knobs}
    for sample in samples:
        truth = truths(sample)
        for knob, declared in knobs.knobs.items():
            errors[knob].append(declared.errors(sample, truth))
    fronts = {}
    for knob, declared in knobs.knobs.items():
        most = np.quantile(np.concatenate(errors[knob]), MOST, axis=0)
        fronts[knob] = [
            Point(choice, float(error), declared.work(choice), _least_ms(declared.run, choice))
            for choice, error in zip(declared.choices, most, strict=True)
        ]
    pictures = max(sum(len(one) for one in found) for found in errors.values())
    return MeasuredFronts(name, pictures, _SEED, fronts)


def _least_ms(run: Callable[[Any], object], choice: int | str) -> float:
    """CPU time, after one call that may compile."""
    run(choice)
    spent = []
    for _ in range(_ROUNDS):
        start = time.process_time()
        run(choice)
        spent.append(time.process_time() - start)
    return round(1e3 * min(spent), 3)


def front_lines(measured: MeasuredFronts) -> Iterator[str]:
    """A Markdown table of the fronts."""
    yield "| knob | choice | error, 99 % of directions in 99 % of pictures | work | CPU ms |"
    yield "|---|---|---:|---:|---:|"
    for knob, front in measured.fronts.items():
        for p in front:
            yield f"| {knob} | {p.choice} | {p.error:.3%} | {p.work:.3g} | {p.cpu_ms:.3g} |"


def check_lines(knobs: ToleranceKnobs[Any], samples: list[Any], truths: Truths) -> Iterator[str]:
    """A Markdown table of how many pictures stay within each tolerance."""
    yield "| tolerance | pictures within | share | 99 % of pictures within |"
    yield "|---:|---:|---:|---:|"
    for tolerance in knobs.tolerances:
        errors = np.concatenate(
            [knobs.picture_errors(sample, truths(sample), tolerance) for sample in samples]
        )
        within, most = int((errors <= tolerance).sum()), np.quantile(errors, MOST)
        share = within / len(errors)
        yield f"| {tolerance:g} | {within} of {len(errors)} | {share:.1%} | {most:.3%} |"


def main() -> None:
    """Print one module's fronts, measured anew if asked, then what it keeps."""
    parser = argparse.ArgumentParser(description="Fronts for the tolerance, and what it keeps.")
    parser.add_argument("module")
    parser.add_argument("--modules", type=Path, action="append", default=[], metavar="FOLDER")
    parser.add_argument("--pictures", type=int, default=200, help="of each of the two sets")
    parser.add_argument("--write", action="store_true", help="measure the fronts anew")
    parser.add_argument("--keep", type=Path, help="a folder that stores the truths")
    asked = parser.parse_args()
    declared = declared_knobs(tuple(asked.modules))
    if asked.module not in declared:
        raise UserError(f"{asked.module!r} declares no knobs, only {', '.join(sorted(declared))}")
    knobs = declared[asked.module]
    measuring, checking = knobs.samples(asked.pictures)
    truths = kept_truths(knobs, asked.keep)
    if asked.write:
        measured = measure(asked.module, knobs, measuring, truths)
        text = msgspec.json.format(msgspec.json.encode(measured), indent=1)
        knobs.fronts.write_bytes(text + b"\n")
    for lines in (front_lines(read_fronts(knobs.fronts)), check_lines(knobs, checking, truths)):
        for line in lines:
            print(line, flush=True)
        print()


if __name__ == "__main__":
    try:
        main()
    except UserError as error:
        sys.exit(str(error))

"""The memory of a window that is worked for long: a tour of all it has, repeated.

    QT_QPA_PLATFORM=offscreen python -m vrut_lite_lab.memory_tour FOLDER \\
        [--tours N] [--openings N] [--play MINUTES] [--size WIDTHxHEIGHT] [--objects]

Writes `memory.csv`, a line after each act: resident memory, what the allocators of C and Python
have given out and keep, compiled code, threads, and the memory of worker processes; with objects of
OpenGL after each chapter. `--objects` writes `objects.txt` too: Python's objects by type and
the arrays that caches hold. `python -m vrut_lite_lab.memory_tour.curve FOLDER` draws it.
"""

import argparse
import csv
import gc
import os
import sys
import tempfile
from collections import Counter
from pathlib import Path
from time import monotonic

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
# As the command line has it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from PySide6.QtWidgets import QApplication

from vrut_lite.lazy import lazy
from vrut_lite_lab.memory_tour.acts import ALTERNATING, project_of, tour
from vrut_lite_lab.memory_tour.gl_memory import GlMemory
from vrut_lite_lab.memory_tour.process_memory import (
    ProcessMemory,
    process_memory,
    python_objects,
)
from vrut_lite_lab.memory_tour.toured_window import TouredWindow

_numba = lazy("vrut_lite.numba_compiler")
_NEW_OBJECTS = 20_000
_FIRST = "street.toml"
_PLAY_SAMPLE_S = 15.0
# Rest after which the window has returned spare memory (app/engine/spare_memory.py): without it a
# resident size says how long ago that was.
_REST_S = 3.0
_COUNTED_TYPES = 40


class MemoryNotes:
    """Writes lines of `memory.csv`, and of `objects.txt` if wanted."""

    def __init__(self, toured: TouredWindow, folder: Path, objects: bool):
        self._toured, self._began_s = toured, monotonic()
        self._file = (folder / "memory.csv").open("w", newline="")
        self._rows = csv.writer(self._file)
        self._rows.writerow(
            ["minute", "chapter", "act", "pictures", *ProcessMemory._fields, *GlMemory._fields]
        )
        self._objects = (folder / "objects.txt").open("w") if objects else None
        self._before: Counter[str] = Counter()
        self.chapter = ""

    def note(self, act: str, with_gl: bool = False) -> ProcessMemory:
        """A line about the moment after an act."""
        found = process_memory()
        gl = list(self._toured.gl_memory()) if with_gl else [""] * len(GlMemory._fields)
        minute = f"{(monotonic() - self._began_s) / 60.0:.2f}"
        numbers = [f"{v:.1f}" if isinstance(v, float) else v for v in (*found, *gl)]
        self._rows.writerow([minute, self.chapter, act, self._toured.pictures, *numbers])
        self._file.flush()
        print(
            f"{minute:>6} min {self.chapter:12} {act:26} {found.resident:7.0f} MiB "
            f"(heap {found.heap_used:.0f} used, {found.heap_free:.0f} free in {found.heaps}; "
            f"Python {found.python:.0f}, {found.blocks} blocks; code {found.code:.0f}; "
            f"workers {found.workers:.0f})" + (f" {gl}" if with_gl else ""),
            flush=True,
        )
        return found

    def note_objects(self) -> None:
        """Python's objects, by type, and how many more they are than before."""
        if self._objects is None:
            return
        kept, before = process_memory().resident, gc.get_count()
        freed = gc.collect()
        say = self._objects
        print(
            f"=== {self.chapter}: {kept:.0f} MiB, {process_memory().resident:.0f} after collecting "
            f"{freed} of {before}",
            file=say,
        )
        gc.unfreeze()
        found = python_objects()
        gc.freeze()
        print(f"arrays: {found.arrays} of {found.arrays_mib:.1f} MiB", file=say)
        for name, size in sorted(found.caches_mib.items(), key=lambda item: -item[1]):
            print(f"  {size:8.1f} MiB {name}", file=say)
        grown = found.counts - self._before
        self._before = found.counts
        for name, count in grown.most_common(_COUNTED_TYPES):
            print(f"  +{count:7d} to {found.counts[name]:7d} {name}", file=say)
        say.flush()

    def close(self) -> None:
        """Close the files."""
        self._file.close()
        if self._objects is not None:
            self._objects.close()


def _tours(toured: TouredWindow, recorder: MemoryNotes, count: int) -> None:
    for number in range(1, count + 1):
        recorder.chapter = f"tour {number}"
        for name, act in tour():
            act(toured)
            recorder.note(name)
        _rest(toured, recorder)


def _openings(toured: TouredWindow, recorder: MemoryNotes, count: int) -> None:
    recorder.chapter = "openings"
    for number in range(1, count + 1):
        scene = ALTERNATING[number % len(ALTERNATING)]
        toured.open(project_of(scene))
        toured.wait(_REST_S)
        recorder.note(f"{number} {scene}")
    if count:
        _rest(toured, recorder)


def _play(toured: TouredWindow, recorder: MemoryNotes, minutes: float) -> None:
    recorder.chapter = "play"
    end_s = monotonic() + 60.0 * minutes
    if minutes <= 0.0:
        return
    toured.open(project_of(_FIRST))
    toured.trigger("play")
    while monotonic() < end_s:
        toured.wait(_PLAY_SAMPLE_S)
        recorder.note("playing")
    toured.trigger("play")
    toured.settle()
    _rest(toured, recorder)


def _rest(toured: TouredWindow, recorder: MemoryNotes) -> None:
    """The window at rest, on the first scene."""
    toured.open(project_of(_FIRST))
    toured.wait(_REST_S)
    recorder.note("rest", with_gl=True)
    recorder.note_objects()


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    return int(width), int(height)


def main() -> None:
    """Tour, open scenes, play; print problems that the window told."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--tours", type=int, default=3)
    parser.add_argument("--openings", type=int, default=50)
    parser.add_argument("--play", type=float, default=0.0, help="minutes")
    parser.add_argument("--size", type=_size, default=(700, 480))
    parser.add_argument("--objects", action="store_true")
    chosen = parser.parse_args()
    chosen.folder.mkdir(parents=True, exist_ok=True)
    # As the command line has it.
    gc.set_threshold(_NEW_OBJECTS)
    _numba.load()
    app = QApplication(sys.argv[:1])
    with tempfile.TemporaryDirectory() as folder:
        toured = TouredWindow(app, Path(folder), chosen.size)
        recorder = MemoryNotes(toured, chosen.folder, chosen.objects)
        recorder.chapter = "start"
        _rest(toured, recorder)
        _tours(toured, recorder, chosen.tours)
        _openings(toured, recorder, chosen.openings)
        _play(toured, recorder, chosen.play)
        toured.close()
        recorder.close()
    for problem in toured.problems:
        print(problem)


if __name__ == "__main__":
    main()

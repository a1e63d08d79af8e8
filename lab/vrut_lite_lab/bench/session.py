"""One run of the benchmark."""

import time
from collections.abc import Callable
from dataclasses import replace

import msgspec

from vrut_lite_lab.bench import gl
from vrut_lite_lab.bench.bench_path import Group
from vrut_lite_lab.bench.compare import Key
from vrut_lite_lab.bench.machine import load, machine
from vrut_lite_lab.bench.registry import KINDS
from vrut_lite_lab.bench.results import FORMAT, GroupNote, MeasuredPath, Results
from vrut_lite_lab.bench.runner import FULL, QUICK, measure_group, pace_s

Tell = Callable[[str], None]


class BenchSession:
    """Measures kinds of computation; `tell` is called with the name of each step."""

    def __init__(self, kinds: list[str], quick: bool, tell: Tell):
        self._kinds, self._quick, self._tell = kinds, quick, tell
        self._effort = QUICK if quick else FULL
        self._load, self._start_s, self._pace_s = load(), time.perf_counter(), pace_s()
        self._notes: dict[str, GroupNote] = {}
        self._found: dict[Key, MeasuredPath] = {}
        self._left_out: dict[str, str] = {}
        # Paths whose figures would be false, and why.
        self.refused: dict[str, str] = {}

    def measure(self) -> None:
        """Measure everything."""
        for group in self._groups():
            self._note(group)
            for path in measure_group(group, self._effort, self._tell, self._refuse):
                self._found[path.group, path.name] = path
            self._pace_s = min(self._pace_s, pace_s())

    def measure_again(self, keys: set[Key]) -> None:
        """Time some paths again; smaller times replace the earlier ones."""
        for group in self._groups():
            paths = tuple(path for path in group.paths if (group.name, path.name) in keys)
            chosen = replace(group, paths=paths)
            for now in measure_group(chosen, self._effort, self._tell, self._refuse):
                before = self._found[now.group, now.name]
                if now.seconds < before.seconds:
                    self._found[now.group, now.name] = msgspec.structs.replace(
                        now, errors=before.errors
                    )

    def results(self) -> Results:
        """The results so far."""
        return Results(
            format=FORMAT,
            quick=self._quick,
            kinds=self._kinds,
            machine=machine(self._load, gl.renderer(), self._pace_s),
            spent_s=time.perf_counter() - self._start_s,
            groups=list(self._notes.values()),
            paths=list(self._found.values()),
            left_out=self._left_out | self.refused,
        )

    def _groups(self) -> list[Group]:
        return [group for kind in self._kinds for group in KINDS[kind](self._quick)]

    def _refuse(self, name: str, reason: str) -> None:
        self.refused[name] = reason

    def _note(self, group: Group) -> None:
        self._left_out |= group.left_out
        self._notes[group.name] = msgspec.convert(group, GroupNote, from_attributes=True)

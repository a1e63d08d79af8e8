"""Paths that are measured by a process of their own, which prints its figures as JSON."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from typing import Any

from vrut_lite.errors import ModuleFailed
from vrut_lite_lab.bench.bench_path import BenchPath, Errors, Parameter, Spent, Work, WorkClock


def figures_of(what: str, module: str, *arguments: object, **environment: str) -> dict[str, Any]:
    """The figures on the last line that a module prints, run in a new process.

    Raises:
        ModuleFailed: the process failed; the sentence begins with `what`.
    """
    answer = subprocess.run(
        [sys.executable, "-m", module, *map(str, arguments)],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    if answer.returncode != 0:
        last = (answer.stderr.strip().splitlines() or ["no message"])[-1]
        raise ModuleFailed(f"{what} could not be measured: {last}")
    return dict(json.loads(answer.stdout.splitlines()[-1]))


def measured_path(
    name: str,
    family: str,
    batch: str,
    clock: str,
    seconds: Callable[[], float],
    error: Callable[[Any], dict[str, Errors]] | None = None,
    parameters: dict[str, Parameter] | None = None,
) -> BenchPath:
    """A path whose seconds another process has measured."""

    def spent(_work: Work) -> Spent:
        taken_s = seconds()
        return Spent(None, taken_s, taken_s)

    return BenchPath(
        name=name,
        family=family,
        parameters=parameters or {},
        prepare=lambda: lambda: None,
        error=error,
        batch=batch,
        clock=WorkClock(clock, spent),
        once=True,
    )

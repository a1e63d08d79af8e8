"""The parts of the check: each a process with a limit of time, whose result is written at once."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

# Writes what it has found so far.
Keep = Callable[[Any], None]


class CheckPart(NamedTuple):
    """A part's title, limit, and module, whose `measure(folder, keep)` does the work."""

    title: str
    limit_s: float
    module: str


PARTS = {
    "driver": CheckPart("Driver and limits", 30, "driver"),
    "start": CheckPart("First pictures of a fresh machine", 60, "first_pictures"),
    "parity": CheckPart("Products of the card beside the processor's", 60, "parity"),
    "tests": CheckPart("Tests that need OpenGL", 180, "gl_tests"),
    "rows": CheckPart("Rows of the benchmark", 60, "rows"),
    "frames": CheckPart("Frames of a fixed path", 110, "frames"),
}


def run_parts(folder: Path, names: list[str], patience: float = 1.0) -> None:
    """Do these parts; one that fails or takes too long leaves what it had found.

    `patience` is a factor of the limits of time, for a processor that plays the card.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        start_s, limit_s = time.perf_counter(), patience * PARTS[name].limit_s
        log = folder / f"{name}.log"
        with log.open("w") as output:
            command = [sys.executable, "-m", "vrut_lite_lab.card_check", "part", name, str(folder)]
            child = subprocess.Popen(
                command, stdout=output, stderr=subprocess.STDOUT, start_new_session=True
            )
            try:
                ended = f"exit code {child.wait(limit_s)}"
            except subprocess.TimeoutExpired:
                ended = f"stopped at its limit of {limit_s:.0f} s"
                os.killpg(child.pid, signal.SIGKILL)
                child.wait()
        took_s = time.perf_counter() - start_s
        end = {"ended": ended, "seconds": round(took_s, 1)}
        (folder / f"{name}_end.json").write_text(json.dumps(end))
        print(f"{name}: {ended}, {took_s:.1f} s", flush=True)
        print(*log.read_text(errors="replace").splitlines()[-4:], sep="\n", flush=True)


def run_part(name: str, folder: Path) -> None:
    """Do a part in this process."""
    folder.mkdir(parents=True, exist_ok=True)

    def keep(found: Any) -> None:
        (folder / f"{name}.json").write_text(json.dumps(found, indent=1))

    import_module(f"vrut_lite_lab.card_check.{PARTS[name].module}").measure(folder, keep)


def result(folder: Path, name: str) -> tuple[Any, dict[str, Any]]:
    """The result of a part, None if there is none, and its end."""
    found, ended = folder / f"{name}.json", folder / f"{name}_end.json"
    return (
        json.loads(found.read_text()) if found.exists() else None,
        json.loads(ended.read_text()) if ended.exists() else {"ended": "not run", "seconds": 0.0},
    )

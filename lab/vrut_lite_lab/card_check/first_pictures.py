"""The first pictures of a machine that has compiled nothing yet, and the next ones.

`vrut-lite render` draws each at 1280 x 720, in a new process.
"""

import subprocess
import sys
import time
from pathlib import Path

from vrut_lite_lab.card_check.parts import Keep
from vrut_lite_lab.checkout import ROOT

_MAIN = "from vrut_lite.cli import main; main()"
_STREET = ("scenes/street.toml", "--at", "2026-06-21T11:00", "--place", "50.0755,14.4378,200")
RUNS = {"nothing compiled": (), "again": (), "another hour": ("--at", "2026-06-21T16:00")}


def measure(folder: Path, keep: Keep) -> None:
    """Draw the street: the second time from what the first has kept."""
    found = {}
    for name, more in RUNS.items():
        start_s = time.perf_counter()
        command = ["render", *_STREET, *more, "--size", "1280x720", "-o"]
        done = subprocess.run(
            [sys.executable, "-c", _MAIN, *command, str(folder / "street.png")],
            cwd=ROOT, capture_output=True, text=True, check=False,
        )  # fmt: skip
        found[name] = {
            "seconds": time.perf_counter() - start_s,
            "exit_code": done.returncode,
            "said": done.stderr[-500:],
        }
        keep(found)

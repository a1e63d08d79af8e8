"""Runs the command line in a separate process, for tests of faults."""

import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
NOON = ["--at", "2026-06-21T12:00Z", "--place", "50,14"]
SMALL_SKY = ["sky", *NOON, "--size", "16"]
PATIENCE_S = 120
# A job that a shell started in the background ignores Ctrl-C.
HEAR_INTERRUPTS = "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)"


def start(*arguments, setting="", cwd=None, **more):
    """`vrut-lite` with its output in pipes; `setting` is Python that runs before it."""
    code = f"{HEAR_INTERRUPTS}\n{setting}\nfrom vrut_lite import cli\ncli.main()"
    environment = {**os.environ, **more.pop("environment", {})}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, **more}
    line = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.Popen(line, env=environment, cwd=cwd or ROOT, **pipes)


def outcome(process):
    """Exit code, standard output, and standard error."""
    try:
        said, complaints = process.communicate(timeout=PATIENCE_S)
    finally:
        process.kill()
    return process.returncode, said, complaints


def is_one_line(complaints):
    """Whether there is one sentence of vrut-lite, and no traceback."""
    assert "Traceback" not in complaints, complaints
    # An echoed Ctrl-C may come on a line before the sentence, and so may the compiler's progress.
    lines = [line for line in complaints.splitlines() if line and "compil" not in line]
    assert len(lines) == 1, complaints
    assert lines[0].startswith("vrut-lite: "), complaints
    return lines[0]


def wait_for(condition, process=None):
    """Wait until a condition holds; an assertion fails if it never does."""
    end_s = time.monotonic() + PATIENCE_S
    while not condition():
        assert process is None or process.poll() is None, "the process has ended"
        assert time.monotonic() < end_s
        time.sleep(0.005)

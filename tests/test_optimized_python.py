"""Nothing depends on docstrings and asserts, which PYTHONOPTIMIZE=2 removes."""

import os
import subprocess
import sys

import pytest
from click.testing import CliRunner
from long_parameters import mostly_long

from vrut_lite.cli import root

SAID_INSTEAD = "PYTHONOPTIMIZE=2 leaves out what would be said here: unset it."
RUN = "from vrut_lite.cli import main; main()"


def optimized(*arguments):
    """Output of the command without docstrings and asserts."""
    return subprocess.run(
        [sys.executable, "-OO", "-c", RUN, *arguments],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("command", mostly_long([[], ["replay"]], bool))
def test_a_help_without_its_text_says_why(command):
    """The help says why its text is missing."""
    assert SAID_INSTEAD in optimized(*command, "--help").stdout
    assert SAID_INSTEAD not in CliRunner().invoke(root, [*command, "--help"]).output


@pytest.mark.long
def test_a_session_replays_with_and_without_asserts(tmp_path):
    """A journal replays to the bit without asserts and docstrings."""
    path = str(tmp_path / "session.mcap")
    done = optimized("record", "-o", path, "--at", "2026-06-21T12:00", "--size", "8")
    assert done.returncode == 0, done.stderr
    said = CliRunner().invoke(root, ["replay", path, "--check"], catch_exceptions=False).output
    assert "are equal, compared by digest" in said

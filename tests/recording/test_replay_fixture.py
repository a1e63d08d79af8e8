"""The pytest plugin for module authors: a journal is a test, and can be accepted anew."""

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from journal_toys import Poke, record_inputs

AUTHORS_TEST = """
    from journal_toys import TOYS, Poke, Parrot
    from vrut_lite.kernel.module import handles

    class Louder(Parrot):
        @handles(Poke)
        def on_poke(self, message):
            super().on_poke(Poke(value=message.value + {change}))

    def test_my_module(replay_journal):
        outcome = replay_journal("journal.mcap", [Louder, *TOYS[1:]])
        assert outcome.inputs == 2
"""


@pytest.fixture
def author(tmp_path):
    """Runs pytest in a folder with a journal and a module that differs by so much."""
    journal = tmp_path / "journal.mcap"
    journal.write_bytes(record_inputs([Poke(value=0.25), Poke(value=0.5)]))
    toys = str(Path(__file__).parent)

    def run(change, *options):
        (tmp_path / "test_author.py").write_text(
            textwrap.dedent(AUTHORS_TEST).format(change=change)
        )
        return subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-p", "vrut_lite.testing", *options],
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": toys, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


@pytest.mark.long
def test_a_journal_passes_fails_and_is_accepted(author, tmp_path):
    """Unchanged it passes; changed it fails and says how; --update-journals accepts the change."""
    before = (tmp_path / "journal.mcap").read_bytes()
    assert author(0.0).returncode == 0
    failed = author(0.125)
    assert failed.returncode == 1
    assert "Echo from parrot: value is 0.375 here and 0.25 in the journal" in failed.stdout
    assert "--update-journals" in failed.stdout
    assert (tmp_path / "journal.mcap").read_bytes() == before
    assert author(0.125, "--update-journals").returncode == 0
    assert (tmp_path / "journal.mcap").read_bytes() != before
    assert author(0.0).returncode == 1

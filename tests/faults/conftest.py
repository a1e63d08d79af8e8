"""Runs the command line in this process, where faults can be injected."""

import sys

import pytest
from fault_stage import is_one_line

from vrut_lite import cli


@pytest.fixture
def refused(monkeypatch, capsys):
    """Run a command that must end with exit code 2 and one line; returns the line."""

    def check(*arguments, code=2):
        monkeypatch.setattr(sys, "argv", ["vrut-lite", *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            cli.main()
        assert end.value.code == code
        return is_one_line(capsys.readouterr().err)

    return check


@pytest.fixture
def done(monkeypatch, capsys):
    """Run a command that must succeed without a complaint; returns its output."""

    def check(*arguments):
        monkeypatch.setattr(sys, "argv", ["vrut-lite", *map(str, arguments)])
        cli.main()
        said = capsys.readouterr()
        assert [line for line in said.err.splitlines() if "compil" not in line] == []
        return said.out

    return check

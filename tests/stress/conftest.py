"""Inputs for the stability suite, and the number of inputs by function."""

import zlib
from collections import Counter

import pytest
from stress_cases import Stress

TALLY: Counter[str] = Counter()


@pytest.fixture
def stress(request):
    """Reproducible inputs of a test, their number scaled by `--stress-scale`."""
    seed = zlib.crc32(request.node.nodeid.partition("::")[2].encode())
    return Stress(request.config.getoption("--stress-scale"), TALLY, seed)


def pytest_terminal_summary(terminalreporter):
    """Print the number of inputs by function in this process."""
    if TALLY:
        terminalreporter.section("inputs by function")
        for function, count in sorted(TALLY.items()):
            terminalreporter.write_line(f"{function:40} {count:>14,}")
        terminalreporter.write_line(f"{'all':40} {sum(TALLY.values()):>14,}")

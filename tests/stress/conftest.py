"""The supply of inputs for the stability suite, and its count of cases by function."""

import zlib
from collections import Counter

import pytest
from stress_cases import Stress

TALLY: Counter[str] = Counter()


@pytest.fixture
def stress(request):
    """Inputs of a test: the same each time, as many as `--stress-scale` says."""
    seed = zlib.crc32(request.node.nodeid.partition("::")[2].encode())
    return Stress(request.config.getoption("--stress-scale"), TALLY, seed)


def pytest_terminal_summary(terminalreporter):
    """How many inputs each function has taken in this process."""
    if TALLY:
        terminalreporter.section("inputs by function")
        for function, count in sorted(TALLY.items()):
            terminalreporter.write_line(f"{function:40} {count:>14,}")
        terminalreporter.write_line(f"{'all':40} {sum(TALLY.values()):>14,}")

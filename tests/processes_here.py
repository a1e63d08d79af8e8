"""Processes for the tests that start some, or the reason why those are skipped."""

import pytest

from vrut_lite.commands.workers import spawn_context
from vrut_lite.errors import UserError


def processes_or_skip() -> None:
    """Skip the test where processes cannot share memory, as in some containers."""
    try:
        spawn_context()
    except UserError as error:
        pytest.skip(str(error))

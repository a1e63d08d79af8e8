"""Skips tests that start processes where these cannot share memory."""

import pytest

from vrut_lite.errors import UserError
from vrut_lite.studio.workers import spawn_context


def processes_or_skip() -> None:
    """Skip the test if processes cannot share memory, as in some containers."""
    try:
        spawn_context()
    except UserError as error:
        pytest.skip(str(error))

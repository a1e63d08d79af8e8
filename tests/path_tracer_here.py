"""mitsuba for the tests that compare with it, or the reason why they are skipped."""

from typing import Any

import pytest
from path_tracer.library import load_mitsuba

from vrut_lite.errors import UserError


def mitsuba_or_skip() -> Any:
    """The package; skips the test, or the whole file, where it or a library of its is missing."""
    try:
        return load_mitsuba()
    except UserError as error:
        pytest.skip(str(error), allow_module_level=True)

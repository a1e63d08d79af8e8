"""mitsuba for the tests that compare with it; skips them where it is missing."""

from typing import Any

import pytest
from path_tracer.library import load_mitsuba

from vrut_lite.errors import UserError


def mitsuba_or_skip() -> Any:
    """The package; skips the test, or the whole file, if it or a library of it is missing."""
    try:
        return load_mitsuba()
    except UserError as error:
        pytest.skip(str(error), allow_module_level=True)

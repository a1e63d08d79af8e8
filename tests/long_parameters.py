"""Parameters of which `make test` tries some and `make test-long` all."""

from collections.abc import Callable, Iterable
from typing import Any

import pytest


def mostly_long(values: Iterable[Any], is_short: Callable[[Any], bool]) -> list[Any]:
    """The values, all but the short ones marked `long`."""
    return [v if is_short(v) else pytest.param(v, marks=pytest.mark.long) for v in values]

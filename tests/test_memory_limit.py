"""The memory limit for files, from the environment."""

import pytest

from vrut_lite.errors import UserError
from vrut_lite.memory_limit import memory_limit_bytes


@pytest.mark.parametrize(
    ("text", "limit_bytes"), [("", 4 << 30), ("8", 8 << 30), (" 0.5 ", 1 << 29)]
)
def test_the_limit_is_given_in_gib(monkeypatch, text, limit_bytes):
    """The variable is in GiB; the default is 4 GiB."""
    monkeypatch.setenv("VRUT_LITE_MEMORY_GIB", text)
    assert memory_limit_bytes() == limit_bytes


@pytest.mark.parametrize(
    "text", ["0", "-1", "lots", "nan", "inf", "1e3", "1_0", "٤", "4 GiB", "9" * 99]
)
def test_invalid_limits_are_refused(monkeypatch, text):
    """Invalid values, zero and negative limits are refused."""
    monkeypatch.setenv("VRUT_LITE_MEMORY_GIB", text)
    with pytest.raises(UserError, match=r"VRUT_LITE_MEMORY_GIB is '.*': give the memory"):
        memory_limit_bytes()

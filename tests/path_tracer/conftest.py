"""What the path tracer's tests share."""

import builtins
import sys

import pytest


@pytest.fixture
def without_mitsuba(monkeypatch):
    """As if the extra were not installed."""
    real = builtins.__import__

    def refuse(name, *arguments, **named):
        if name.split(".")[0] == "mitsuba":
            raise ModuleNotFoundError(f"No module named '{name}'")
        return real(name, *arguments, **named)

    monkeypatch.delitem(sys.modules, "mitsuba", raising=False)
    monkeypatch.setattr(builtins, "__import__", refuse)

"""Old names that still work, with a warning that names the new one: docs/promises.md.

A name is deprecated in a minor version, works in that one and in the next, and may go in the one
after. Names of messages, of their fields and of settings stay in journals for ever:
`recording/earlier_names.py` reads them.
"""

import functools
import warnings
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])
# Minor versions in which a deprecated name works.
LIVES = 2
# Attribute of a deprecated function: the version since which it is.
SINCE = "__deprecated_since__"


def deprecated(*, since: str, instead: str) -> Callable[[F], F]:
    """Mark a function or method as deprecated; each call of it warns.

    Args:
        since: version, such as "1.2", that deprecates it.
        instead: what to write in its place.
    """

    def mark(function: F) -> F:
        @functools.wraps(function)
        def warns(*arguments: Any, **named: Any) -> Any:
            _warn(function.__qualname__, since, instead)
            return function(*arguments, **named)

        setattr(warns, SINCE, since)
        marked: Any = warns
        return marked

    return mark


class MovedNames:
    """The `__getattr__` of a python module whose names have moved; the use of one warns.

    Args:
        module: the module's own name.
        homes: new modules by name.
        since: version that deprecates them.
    """

    def __init__(self, module: str, homes: Mapping[str, str], *, since: str):
        self.module, self.homes, self.since = module, homes, since

    def __call__(self, name: str) -> Any:
        """The object in its new home.

        Raises:
            AttributeError: no such name was ever there.
        """
        if name not in self.homes:
            raise AttributeError(f"module {self.module!r} has no attribute {name!r}")
        _warn(f"{self.module}.{name}", self.since, f"{self.homes[name]}.{name}")
        return getattr(import_module(self.homes[name]), name)


def is_due(since: str, today: str) -> bool:
    """Whether a name deprecated since a version may go, or must have gone, in today's."""
    (old_major, old_minor), (major, minor) = (_numbers(text) for text in (since, today))
    return major > old_major or (major == old_major and minor >= old_minor + LIVES)


def _numbers(version: str) -> tuple[int, int]:
    major, minor = version.split(".")[:2]
    return int(major), int(minor)


def _warn(name: str, since: str, instead: str) -> None:
    """Warn at the place that uses the name."""
    message = f"{name} is deprecated since vrut_lite {since}: use {instead}"
    warnings.warn(message, DeprecationWarning, stacklevel=3)

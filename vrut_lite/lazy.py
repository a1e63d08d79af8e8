"""Names whose python modules are imported at their first use.

For libraries that many starts need not wait for, or that may be missing. All other imports stand at
the top of their files.
"""

import importlib
from typing import Any


class Lazy:
    """A python module, or one of its names, that is imported when it is first used."""

    def __init__(self, target: str):
        self._target = target

    def load(self) -> Any:
        """The module, or the object of that name in it."""
        module, _, name = self._target.partition(":")
        loaded = importlib.import_module(module)
        return getattr(loaded, name) if name else loaded

    def __getattr__(self, name: str) -> Any:
        return getattr(self.load(), name)

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call the object."""
        return self.load()(*arguments, **named)


def lazy(target: str) -> Any:
    """`"package.module"`, or `"package.module:name"`, imported at its first use."""
    return Lazy(target)

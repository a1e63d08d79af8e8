"""Limits injected inputs of one type to one at a time."""

import threading
from collections.abc import Callable
from typing import Any

from vrut_lite.kernel.messages import Input


class Paced:
    """Injects inputs of one type, one at a time; while one waits, later ones are merged.

    So endless junk, or endless connecting, fills no memory, and counts stay right.
    """

    def __init__(self, tell: Callable[[Input], None]):
        self._tell = tell
        self._next: Any = None
        self._waiting = False
        self._lock = threading.Lock()

    def put(self, message: Input) -> None:
        """Inject an input, now or merged into the next one; from any thread."""
        with self._lock:
            self._next = message if self._next is None else message.merged(self._next)
            self._flush()

    def heard(self) -> None:
        """The last input was handled: inject the inputs that have arrived since."""
        with self._lock:
            self._waiting = False
            self._flush()

    def _flush(self) -> None:
        if self._next is not None and not self._waiting:
            self._waiting = True
            self._tell(self._next)
            self._next = None

"""Inputs at the pace at which they are heard."""

import threading
from collections.abc import Callable
from typing import Any

from vrut_lite.kernel.messages import Input


class Paced:
    """Tells inputs of one type, one at a time; while one waits, its successors merge.

    A stranger who sends rubbish or comes and goes without end fills no memory, and no count is
    lost.
    """

    def __init__(self, tell: Callable[[Input], None]):
        self._tell = tell
        self._next: Any = None
        self._waiting = False
        self._lock = threading.Lock()

    def put(self, message: Input) -> None:
        """Tell this, now or merged into what is told next; from any thread."""
        with self._lock:
            self._next = message if self._next is None else message.merged(self._next)
            self._flush()

    def heard(self) -> None:
        """What was told last was heard: tell what has come since."""
        with self._lock:
            self._waiting = False
            self._flush()

    def _flush(self) -> None:
        if self._next is not None and not self._waiting:
            self._waiting = True
            self._tell(self._next)
            self._next = None

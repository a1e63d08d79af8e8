"""From a background thread to Qt's, for as long as there is somebody to take it."""

import threading
from collections.abc import Callable
from typing import Any


class HandOver:
    """Calls `emit`, which posts to an object of Qt's, until it is closed.

    A window may be gone before its threads have noticed: a signal of an object that Qt is just
    deleting writes into memory that is somebody else's by then. Closed before that, it does not.
    """

    def __init__(self, emit: Callable[..., None]):
        self._emit = emit
        self._lock = threading.Lock()
        self._closed = False

    def __call__(self, *values: Any) -> None:
        """Post, from any thread; nothing once it is closed."""
        with self._lock:
            if not self._closed:
                self._emit(*values)

    def close(self) -> None:
        """Post no more; what is being posted is posted when this returns."""
        with self._lock:
            self._closed = True

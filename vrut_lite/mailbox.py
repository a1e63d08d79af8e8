"""Hands the latest values from one thread to another, with one wake-up."""

import threading
from collections.abc import Callable, Hashable
from typing import Any


class Mailbox:
    """Keeps the latest value of each key; wakes its reader once until it has read.

    A busy reader later finds one value of each key, the latest. `wake` is
    called on the thread that puts and must only tell the reader to come (post an event). After
    `close` it is called no more: a signal of an object that Qt is deleting ends the process.
    """

    def __init__(self, wake: Callable[[], None]):
        self._wake = wake
        self._values: dict[Hashable, Any] = {}
        self._lock = threading.RLock()
        self._closed = False

    def put(self, key: Hashable, value: Any) -> None:
        """Leave a value, in place of an unread one of the same key; from any thread."""
        with self._lock:
            was_empty = not self._values
            # Taken out first: values are read in the order in which they were put.
            self._values.pop(key, None)
            self._values[key] = value
            if was_empty and not self._closed:
                self._wake()

    def take_all(self) -> dict[Hashable, Any]:
        """The unread values by key; the next put wakes again."""
        with self._lock:
            values, self._values = self._values, {}
        return values

    def close(self) -> None:
        """Stop waking; a running `wake` has returned when this returns."""
        with self._lock:
            self._closed = True

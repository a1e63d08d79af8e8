"""A thread that handles items in order, of each key only the latest."""

import threading
from collections.abc import Callable, Hashable
from typing import Any

from vrut_lite.mailbox import Mailbox


class Worker:
    """Calls `begin`, then `handle(key, item)` for each item put, and `end` when closed.

    None of them may raise. `close` drops waiting items.
    """

    def __init__(
        self,
        name: str,
        handle: Callable[[Any, Any], None],
        begin: Callable[[], None] = lambda: None,
        end: Callable[[], None] = lambda: None,
    ):
        self._handle, self._begin, self._end = handle, begin, end
        self._awake = threading.Event()
        self._mailbox = Mailbox(self._awake.set)
        self._closing = False
        self._thread = threading.Thread(target=self._run, name=f"zenoh_bridge {name}", daemon=True)

    def start(self) -> None:
        """Start the worker's thread."""
        self._thread.start()

    def put(self, key: Hashable, item: Any) -> None:
        """Add an item; it replaces a waiting item of the same key."""
        self._mailbox.put(key, item)

    def close(self) -> None:
        """Stop; returns at once."""
        self._closing = True
        self._awake.set()

    def join(self, timeout_s: float) -> None:
        """Wait until the thread has ended."""
        self._thread.join(timeout_s)

    def _run(self) -> None:
        self._begin()
        while not self._closing:
            self._awake.wait()
            self._awake.clear()
            for key, item in self._mailbox.take_all().items():
                if self._closing:
                    break
                self._handle(key, item)
        self._end()

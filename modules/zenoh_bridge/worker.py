"""A thread that does what comes in: the latest of each key, in the order it came."""

import threading
from collections.abc import Callable, Hashable
from typing import Any

from vrut_lite.mailbox import Mailbox


class Worker:
    """Calls `begin`, then `handle(key, item)` for what is put, and `end` when closed.

    None of them may raise. What waits when `close` is called is dropped.
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
        """Begin, on the worker's own thread."""
        self._thread.start()

    def put(self, key: Hashable, item: Any) -> None:
        """Leave something to do, in place of what waits under the same key."""
        self._mailbox.put(key, item)

    def close(self) -> None:
        """Do nothing more, and end; returns at once."""
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

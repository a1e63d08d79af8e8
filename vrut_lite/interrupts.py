"""Ctrl-C while libraries are being loaded."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Deliver Ctrl-C only afterwards; outside the main thread, which alone hears it, no change.

    Libraries that try optional imports with a bare `except` swallow an interrupt that arrives
    while they are loaded, and the command would run on. A handler that only remembers serves
    where a blocked signal does not: another thread of the process would take it.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _frame: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if came and callable(before):
        before(came[0], None)

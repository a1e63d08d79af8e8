"""Ctrl-C in a program with workers: a terminal sends it to all, and the program handles it."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interrupts_blocked() -> Iterator[None]:
    """Block Ctrl-C in threads and processes that start meanwhile; it comes here afterwards.

    Windows cannot block it: there a process that starts may still see one.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def ignore_interrupts() -> None:
    """Let a worker process of this machine ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

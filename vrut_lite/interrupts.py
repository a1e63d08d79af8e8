"""Ctrl-C while libraries are being loaded, requests to end, and what is neither."""

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


class Terminated(BaseException):
    """Someone asked the process to end (SIGTERM): what is unfinished is to be cleared away."""


@contextmanager
def terminations_raised() -> Iterator[None]:
    """Let SIGTERM raise `Terminated`, as Ctrl-C raises, so that files and workers are cleared.

    Outside the main thread, which alone hears signals, no change.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, _raise_terminated)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _raise_terminated(_number: int, _frame: object) -> None:
    # Once: a second request must not end the clearing away.
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise Terminated


def pass_interrupt(error: BaseException, during: str = "") -> None:
    """Raise an exception anew that asks the process to end; return for one of a module's own.

    Python raises Ctrl-C and requests to end in the main thread alone: on any other thread such an
    exception was raised by whoever wrote the code that ran. `during` names what was interrupted,
    for `interrupted_during`.
    """
    asked = isinstance(error, KeyboardInterrupt | Terminated)
    if asked and threading.current_thread() is threading.main_thread():
        if during:
            error.add_note(during)
        raise error


def interrupted_during(error: BaseException) -> str:
    """What an exception that asks to end came in the midst of, or nothing."""
    origin = error.__cause__ or error
    return ", ".join(getattr(origin, "__notes__", ()))

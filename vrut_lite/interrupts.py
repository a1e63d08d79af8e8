"""Ctrl-C and SIGTERM: delayed while libraries load, and told apart from modules' exceptions."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interrupts_held(*numbers: signal.Signals) -> Iterator[None]:
    """Delay Ctrl-C, or signals of these numbers, until the block ends.

    No effect outside the main thread, which alone gets them. Libraries that try optional imports
    with a bare `except` would swallow an interrupt, and the command would go on. A handler records
    the signal; blocking it would fail, because another thread of the process would receive it.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before = {
        number: signal.signal(number, lambda number, _frame: came.append(number))
        for number in numbers or (signal.SIGINT,)
    }
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for received in dict.fromkeys(came):
            signal.raise_signal(received)


class Terminated(BaseException):
    """The process received SIGTERM; unfinished files and workers must be removed."""


@contextmanager
def terminations_raised() -> Iterator[None]:
    """Let SIGTERM raise `Terminated`, so that unfinished files and workers are removed.

    No effect outside the main thread, which alone receives signals.
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
    # Only once: a second SIGTERM must not interrupt the clean-up.
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise Terminated


def pass_interrupt(error: BaseException, during: str = "") -> None:
    """Raise Ctrl-C and SIGTERM again; return for any other exception, which is a module's.

    Python raises Ctrl-C and `Terminated` only in the main thread: on another thread the code that
    ran raised such an exception itself. `during` names the interrupted work, for
    `interrupted_during`.
    """
    asked = isinstance(error, KeyboardInterrupt | Terminated)
    if asked and threading.current_thread() is threading.main_thread():
        if during:
            error.add_note(during)
        raise error


def interrupted_during(error: BaseException) -> str:
    """The name of the interrupted work, or an empty text."""
    origin = error.__cause__ or error
    return ", ".join(getattr(origin, "__notes__", ()))

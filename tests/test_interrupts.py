"""Ctrl-C ends a command even while libraries are being loaded."""

import signal
import threading

import pytest

from vrut_lite.interrupts import interrupts_held


@pytest.fixture
def heard():
    """Restores Ctrl-C, which a job that a shell started in the background ignores."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_an_interrupt_that_would_be_swallowed_comes_afterwards(heard):
    """A bare `except` inside does not swallow it; it is raised after the block."""
    swallowed, went_on = [], []

    def load():
        with interrupts_held(), interrupts_held():
            try:
                signal.raise_signal(signal.SIGINT)
            except BaseException as error:
                swallowed.append(error)
            went_on.append(True)

    with pytest.raises(KeyboardInterrupt):
        load()
    assert (swallowed, went_on) == ([], [True])
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_other_threads_load_as_ever():
    """On other threads, which may not set handlers, nothing changes."""
    done = []

    def load():
        with interrupts_held():
            done.append(True)

    thread = threading.Thread(target=load)
    thread.start()
    thread.join()
    assert done

"""Garbage is collected on Qt's thread alone: Qt objects freed elsewhere can stop the window."""

import gc
import threading

from vrut_lite.app.engine.garbage import GarbageOnQtThread


class Cycle:
    """Notes the thread that frees it, once garbage is collected: it holds itself."""

    def __init__(self, freed_on):
        self.freed_on = freed_on
        self.itself = self

    def __del__(self):
        self.freed_on.append(threading.current_thread())


def make_garbage(freed_on):
    """More than a collection of the youngest objects waits for."""
    for _ in range(5 * gc.get_threshold()[0]):
        Cycle(freed_on)


def test_garbage_of_the_engine_is_collected_on_qts_thread(headless_window):
    """While a window is open; and it is collected, so memory does not grow."""
    freed_on = []

    def question(stage):
        make_garbage(freed_on)
        return threading.current_thread()

    engine = headless_window.asked(question)
    headless_window.until(lambda: bool(freed_on))
    assert set(freed_on) == {threading.main_thread()} != {engine}


def test_the_interpreter_collects_again_after_the_last_window(qapp):
    """Closing leaves a process that a program of its own may go on with."""
    first, second = (GarbageOnQtThread(qapp) for _ in range(2))
    assert gc.isenabled()
    first.start()
    second.start()
    first.stop()
    assert not gc.isenabled()
    second.stop()
    second.stop()
    assert gc.isenabled()

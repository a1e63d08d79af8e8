"""Whether windows that are opened and closed leave anything behind.

    QT_QPA_PLATFORM=offscreen python -m vrut_lite_lab.window_cycles [TIMES]

Each time a window with a host of its own draws one finished picture with OpenGL and is closed. It
prints the process's memory, its files and threads, how many windows and sessions are still alive,
and how many objects OpenGL had in the window's context before it was closed.

Blocks of a MiB and more are given back to the system at once. glibc would learn from the first of
them to keep its like, in holes that later ones do not quite fit: 80 MiB of free
memory that come and go and hide what is left behind.
"""

import ctypes
import gc
import os
import sys
import threading
import weakref
from collections.abc import Callable
from pathlib import Path

import numpy as np

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
# As the command line has it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QApplication

from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import GlStage
from vrut_lite.app.window.main_window import MainWindow
from vrut_lite.project import load_project

SIZE = (640, 480)
_TOLD_EACH = 20
_NAMES = range(1, 2000)
# Until then the caches of Mesa's shaders, of Python's modules and of the allocator fill.
_SETTLED = 60
_M_MMAP_THRESHOLD, _LARGE_BYTES = -3, 2**20


class CountedStage(GlStage):
    """Knows how many objects its context has."""

    def gl_objects(self) -> int:
        """Textures, buffers, framebuffers, vertex arrays and programs."""

        def count(_context: object) -> int:
            from OpenGL import GL

            kinds = (GL.glIsTexture, GL.glIsBuffer, GL.glIsFramebuffer, GL.glIsVertexArray,
                     GL.glIsProgram)  # fmt: skip
            return sum(bool(kind(name)) for kind in kinds for name in _NAMES)

        return self.host.gl.call(count)


class Cycles:
    """An application in which windows come and go."""

    def __init__(self) -> None:
        self.app = QApplication([])
        self._alive: weakref.WeakSet[object] = weakref.WeakSet()

    def one(self) -> int:
        """Open, draw, close; how many objects OpenGL had."""
        session = Session(CountedStage)
        window = MainWindow(session)
        window.resize(*SIZE)
        window.show()
        session.start()
        window.files.open_project(load_project("scenes/sundial.toml"))
        self._until(lambda: session.shown is not None and session.shown.still)
        counts: list[int] = []
        session.ask(lambda stage: stage.gl_objects(), counts.append)  # type: ignore[attr-defined]
        self._until(lambda: bool(counts))
        window.close()
        self._until(lambda: session.has_ended)
        session.join()
        self._alive.update((window, session))
        for closed in (window, session):
            closed.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        return counts[0]

    @property
    def alive(self) -> int:
        """Windows and sessions that were closed and are still there."""
        gc.collect()
        return len(self._alive)

    def _until(self, condition: Callable[[], bool]) -> None:
        while not condition():
            self.app.processEvents()


def resident_mib() -> float:
    """The process's memory."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


def growth_mib(memory_mib: list[float]) -> float:
    """By how much memory grows a window, by a line through all of them."""
    return float(np.polyfit(np.arange(len(memory_mib)), memory_mib, 1)[0])


def main() -> None:
    """Print a line each 20 windows, and by how much memory grew from the sixtieth on."""
    times = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    ctypes.CDLL(None).mallopt(_M_MMAP_THRESHOLD, _LARGE_BYTES)
    cycles = Cycles()
    memory_mib = []
    for number in range(1, times + 1):
        objects = cycles.one()
        alive = cycles.alive
        memory_mib.append(resident_mib())
        if number == 1 or number % _TOLD_EACH == 0:
            print(
                f"{number:4d} windows: {memory_mib[-1]:6.1f} MiB, "
                f"{len(os.listdir('/proc/self/fd')):3d} files, {threading.active_count():2d} "
                f"threads, {alive} alive, {objects} GL objects",
                flush=True,
            )
    settled = memory_mib[_SETTLED:]
    if len(settled) > 1:
        print(f"from window {_SETTLED} on: {growth_mib(settled):+.3f} MiB a window")


if __name__ == "__main__":
    main()

"""Returns memory that the C library keeps for later to the system.

glibc keeps freed memory, in up to eight arenas a core. After a scene was opened or a sky solved
that is a third of the process, and more with each scene, since new arrays do not fit old holes.
"""

import ctypes
import threading
from collections.abc import Callable
from functools import cache

from PySide6.QtCore import QObject

from vrut_lite import operating_system
from vrut_lite.app.widgets import make_timer

# Without a picture for so long the window rests; while pictures go on it is done now and then.
_REST_MS, _BUSY_MS = 2_000, 30_000


class SpareMemory(QObject):
    """Returns spare memory after pictures; up to 12 ms of CPU, on a separate thread."""

    def __init__(self, parent: QObject):
        super().__init__(parent)
        self._rest = make_timer(self, _REST_MS, self._give_back, once=True)
        self._busy = make_timer(self, _BUSY_MS, self._give_back, once=True)
        self._thread: threading.Thread | None = None

    def picture_shown(self) -> None:
        """Wait for the end of pictures, or for half a minute of them."""
        if malloc_trim() is None:
            return
        self._rest.start()
        if not self._busy.isActive():
            self._busy.start()

    def stop(self) -> None:
        """Return nothing more."""
        self._rest.stop()
        self._busy.stop()

    def _give_back(self) -> None:
        self.stop()
        trim = malloc_trim()
        if trim is not None and (self._thread is None or not self._thread.is_alive()):
            # ctypes releases Python's lock meanwhile.
            self._thread = threading.Thread(target=trim, args=(0,), name="vrut-lite spare memory")
            self._thread.start()


@cache
def malloc_trim() -> Callable[[int], int] | None:
    """glibc's function that returns free pages of all arenas; None with another C library."""
    if operating_system.NAME != "linux":
        return None
    return getattr(ctypes.CDLL(None), "malloc_trim", None)

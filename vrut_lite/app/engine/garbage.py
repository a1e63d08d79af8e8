"""Collects garbage on Qt's thread alone, while a window is open.

By default Python collects on whichever thread allocates. A Qt object that such a collection frees
cuts its connections: the thread holds one of Qt's locks and waits for the interpreter's, while
Qt's own thread may hold the interpreter's and wait for Qt's. Both then wait for ever.
"""

import gc

from PySide6.QtCore import QObject, QTimer

_EVERY_MS = 100


class GarbageOnQtThread(QObject):
    """Between `start` and `stop` no other thread collects; several may be started at once."""

    _started = 0

    def __init__(self, parent: QObject):
        super().__init__(parent)
        self._timer = QTimer(self)
        self._timer.setInterval(_EVERY_MS)
        self._timer.timeout.connect(_collect_what_is_due)

    def start(self) -> None:
        """Take collecting over from the interpreter."""
        if not self._timer.isActive():
            GarbageOnQtThread._started += 1
            gc.disable()
            self._timer.start()

    def stop(self) -> None:
        """Collect once more, and leave collecting to the interpreter after the last one."""
        if self._timer.isActive():
            self._timer.stop()
            GarbageOnQtThread._started -= 1
            gc.collect()
            if not GarbageOnQtThread._started:
                gc.enable()


def _collect_what_is_due() -> None:
    """Collect the oldest generation whose threshold is passed, as the interpreter does."""
    counts_and_thresholds = list(zip(gc.get_count(), gc.get_threshold(), strict=True))
    for generation in (2, 1, 0):
        count, threshold = counts_and_thresholds[generation]
        if count > threshold:
            gc.collect(generation)
            return

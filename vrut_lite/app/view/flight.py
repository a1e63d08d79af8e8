"""Flying while keys are held."""

from collections.abc import Callable
from time import perf_counter

import numpy as np
from PySide6.QtCore import QObject, Qt, Signal

from vrut_lite.app.widgets import make_timer
from vrut_lite.numeric_types import FloatArray

_PERIOD_MS = 16
_MOST_STEP_S = 0.1
_FASTER = 4.0
# Right, up and forward.
_WAYS = {
    Qt.Key.Key_D: (1.0, 0.0, 0.0), Qt.Key.Key_A: (-1.0, 0.0, 0.0),
    Qt.Key.Key_E: (0.0, 1.0, 0.0), Qt.Key.Key_Q: (0.0, -1.0, 0.0),
    Qt.Key.Key_W: (0.0, 0.0, 1.0), Qt.Key.Key_S: (0.0, 0.0, -1.0),
    Qt.Key.Key_Shift: (0.0, 0.0, 0.0),
}  # fmt: skip


class Flight(QObject):
    """`flown` emits each step's way in metres: right, up and forward.

    `speed_m_s()` is asked at each step.
    """

    flown = Signal(object)

    def __init__(self, speed_m_s: Callable[[], float], parent: QObject | None = None):
        super().__init__(parent)
        self._speed_m_s = speed_m_s
        self._held: set[Qt.Key] = set()
        self._timer = make_timer(self, _PERIOD_MS, self._fly_on)
        self._flew_s = 0.0

    @property
    def is_on(self) -> bool:
        """Whether a key is held."""
        return bool(self._held)

    def hold(self, key: Qt.Key) -> bool:
        """Fly that way until it is released; False for a key of no way."""
        if key not in _WAYS:
            return False
        self._held.add(key)
        if not self._timer.isActive():
            self._flew_s = perf_counter()
            self._timer.start()
        return True

    def release(self, key: Qt.Key) -> None:
        """No longer fly that way."""
        self._held.discard(key)

    def end(self) -> None:
        """Forget all held keys."""
        self._held.clear()
        self._timer.stop()

    def _fly_on(self) -> None:
        if not self._held:
            self._timer.stop()
            return
        now_s = perf_counter()
        elapsed_s = min(now_s - self._flew_s, _MOST_STEP_S)
        self._flew_s = now_s
        speed_m_s = self._speed_m_s() * (_FASTER if Qt.Key.Key_Shift in self._held else 1.0)
        ways: FloatArray = np.sum([_WAYS[key] for key in self._held], axis=0)
        self.flown.emit(ways * speed_m_s * elapsed_s)

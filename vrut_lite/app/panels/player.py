"""Plays time at a speed, no faster than the kernel follows."""

from time import perf_counter

from PySide6.QtCore import QObject, QTimer, Signal

from vrut_lite.app.engine.session import Session
from vrut_lite.kernel.messages import ClockMoved, SetClockRate, Tick

_PERIOD_MS = 33


class Player(QObject):
    """Sends a tick when the one before has moved the clock: ticks grow longer, none are queued."""

    playing_changed = Signal(bool)

    def __init__(self, session: Session, parent: QObject | None = None):
        super().__init__(parent)
        self._session = session
        self._rate = 600.0
        self._last_s = 0.0
        self._waiting = False
        self._timer = QTimer(self)
        self._timer.setInterval(_PERIOD_MS)
        self._timer.timeout.connect(self._tick)
        session.listen(ClockMoved, self._moved)

    @property
    def playing(self) -> bool:
        """Whether time goes by."""
        return self._timer.isActive()

    def play(self) -> None:
        """Let time go by."""
        self._last_s = perf_counter()
        self._waiting = False
        self._session.send(SetClockRate(rate=self._rate))
        self._timer.start()
        self.playing_changed.emit(True)

    def pause(self) -> None:
        """Stand still."""
        if self.playing:
            self._timer.stop()
            self._session.send(SetClockRate(rate=0.0))
            self.playing_changed.emit(False)

    def set_rate(self, rate: float) -> None:
        """So many seconds of the clock in one outside; negative goes back."""
        self._rate = rate
        if self.playing:
            self._session.send(SetClockRate(rate=rate))

    def _tick(self) -> None:
        if self._waiting:
            return
        now_s = perf_counter()
        self._waiting = True
        self._session.send(Tick(elapsed_s=now_s - self._last_s))
        self._last_s = now_s

    def _moved(self, _: ClockMoved) -> None:
        self._waiting = False

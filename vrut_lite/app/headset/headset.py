"""The headset of a window: enters and leaves it, and sends its user's inputs to the session."""

from datetime import timedelta
from typing import Any

from PySide6.QtCore import QObject, Qt, Signal

from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import GlStage, Stage
from vrut_lite.app.headset.loop import HeadsetLoop
from vrut_lite.app.view.viewport import Viewport
from vrut_lite.errors import UserError
from vrut_lite.host import Host
from vrut_lite.kernel.messages import ClockMoved, SetClock


class Headset(QObject):
    """Signals: `changed` with whether the headset shows the scene, and `news`, a sentence."""

    changed = Signal(bool)
    news = Signal(str)
    _told = Signal(str, object)

    def __init__(self, session: Session, viewport: Viewport, parent: QObject | None = None):
        super().__init__(parent)
        self._session, self._viewport = session, viewport
        self._loop: HeadsetLoop | None = None
        # Seconds by which the clock is still to move, and whether it is moving.
        self._wanted_s, self._clock_moves = 0.0, False
        self._told.connect(self._take, Qt.ConnectionType.QueuedConnection)
        session.listen(ClockMoved, self._clock_moved)

    def toggle(self) -> None:
        """Enter the headset, or leave it."""
        if self._loop is None:
            self._session.ask(_host_of, self._enter)
        else:
            self._loop.stop()

    def _enter(self, host: Host) -> None:
        if self._loop is None:
            self._loop = HeadsetLoop(host, self._told.emit)
            self._session.watch(self._loop)
            self._loop.start()

    def _take(self, kind: str, value: Any) -> None:
        """Act on news of the headset's thread, on Qt's thread."""
        if kind == "entered":
            self.news.emit(f"In the headset: {value[0]} x {value[1]} pixels an eye")
            self.changed.emit(True)
        elif kind == "moved":
            self._viewport.go_to(value)
        elif kind == "hour":
            self._wanted_s += value
            self._move_clock()
        else:
            self._left(value)

    def _left(self, problem: str) -> None:
        self._loop = None
        self._session.watch(None)
        self.changed.emit(False)
        if problem:
            self._session.problem.emit(problem)

    def _move_clock(self) -> None:
        """Move the clock once the last move has come through: a slow kernel gets longer steps."""
        clock = self._session.last(ClockMoved)
        if clock is None or self._clock_moves or not self._wanted_s:
            return
        instant = clock.instant + timedelta(seconds=self._wanted_s)
        self._wanted_s, self._clock_moves = 0.0, True
        self._session.send(SetClock(instant=instant))

    def _clock_moved(self, _: ClockMoved) -> None:
        self._clock_moves = False
        self._move_clock()


def _host_of(stage: Stage) -> Host:
    """The host that draws by OpenGL.

    Raises:
        UserError: the stage has none.
    """
    if not isinstance(stage, GlStage):
        raise UserError("VR needs OpenGL 4.3, which this machine does not have")
    return stage.host

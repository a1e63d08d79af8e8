"""Overlay while a scene is opened: its name, the seconds, a moving bar."""

from pathlib import Path
from time import perf_counter

from PySide6.QtCore import QObject, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter

from vrut_lite.app import theme
from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.session import Session
from vrut_lite.app.widgets import make_timer
from vrut_lite.kernel.messages import Fault, Input
from vrut_lite.messages.scene import LoadScene, SceneOpened

_PERIOD_MS = 40
# Seconds for the light to run along its bar.
_RUN_S = 1.4
_BAR_WIDTH_PX, _BAR_HEIGHT_PX, _LIGHT_SHARE = 240.0, 4.0, 0.3
_LINE_PX = 22.0
_TOLD_FROM_S = 1.0
_SCENE = "scene"


class Loading(QObject):
    """From the wish for a scene to its first picture, or to the line that refuses it.

    `changed` is emitted many times a second meanwhile; the window's thread is free for it.
    """

    changed = Signal()

    def __init__(self, session: Session, parent: QObject | None = None):
        super().__init__(parent)
        self._path = ""
        self._is_opened = False
        self._began_s = perf_counter()
        self._timer = make_timer(self, _PERIOD_MS, self.changed.emit)
        self._timer.start()
        session.sent.connect(self._note_wish)
        session.listen(SceneOpened, self._note_scene)
        session.listen(Fault, self._note_fault)
        session.picture_shown.connect(self._note_picture)
        session.ready.connect(lambda _: self._note_host())
        session.closing.connect(self._timer.stop)

    @property
    def is_on(self) -> bool:
        """Whether something is being opened."""
        return self._timer.isActive()

    @property
    def text(self) -> str:
        """The file being opened, with its seconds; empty without one."""
        if not self.is_on:
            return ""
        # The first picture follows when the light of its hour is there.
        doing = "Lighting" if self._is_opened else "Opening"
        words = [doing, Path(self._path).name, "\N{HORIZONTAL ELLIPSIS}"]
        seconds = perf_counter() - self._began_s
        if seconds >= _TOLD_FROM_S:
            words.append(f" {seconds:.0f} s")
        return " ".join(word for word in words if word)

    def begin(self, path: str) -> None:
        """A scene will be opened."""
        if not self.is_on or path != self._path:
            self._began_s = perf_counter()
        self._path, self._is_opened = path, False
        self._timer.start()
        self.changed.emit()

    def _note_wish(self, message: Input) -> None:
        if isinstance(message, LoadScene):
            self.begin(message.path)

    def _note_scene(self, scene: SceneOpened) -> None:
        self._is_opened = True

    def _note_fault(self, fault: Fault) -> None:
        if fault.module == _SCENE:
            self._end()

    def _note_picture(self, shown: Shown) -> None:
        if self._is_opened or not self._path:
            self._end()

    def _note_host(self) -> None:
        if not self._path:
            self._end()

    def _end(self) -> None:
        self._timer.stop()
        self.changed.emit()

    def region(self, place: QRectF) -> QRectF:
        """The rectangle that `paint` draws into."""
        width = min(_BAR_WIDTH_PX + 60.0, place.width())
        region = QRectF(0.0, 0.0, width, _BAR_HEIGHT_PX + 28.0 + _LINE_PX)
        region.moveCenter(place.center())
        return region

    def paint(self, painter: QPainter, place: QRectF) -> None:
        """Draw the bar and its text into the middle of a place."""
        if not self.is_on:
            return
        behind = self.region(place)
        bar = QRectF(
            behind.left() + 30.0, behind.top() + 14.0, behind.width() - 60.0, _BAR_HEIGHT_PX
        )
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(16, 16, 18, 200))
        painter.drawRoundedRect(behind, 6.0, 6.0)
        painter.setBrush(QColor(theme.LINE))
        painter.drawRoundedRect(bar, 2.0, 2.0)
        # To and fro.
        turn = (perf_counter() - self._began_s) / _RUN_S % 2.0
        share = turn if turn <= 1.0 else 2.0 - turn
        light = QRectF(bar)
        light.setWidth(_LIGHT_SHARE * bar.width())
        light.moveLeft(bar.left() + share * (1.0 - _LIGHT_SHARE) * bar.width())
        painter.setBrush(QColor(theme.ACCENT))
        painter.drawRoundedRect(light, 2.0, 2.0)
        painter.setPen(QColor(theme.TEXT))
        line = QRectF(behind.left(), bar.bottom() + 6.0, behind.width(), _LINE_PX)
        painter.drawText(line, Qt.AlignmentFlag.AlignCenter, self.text)

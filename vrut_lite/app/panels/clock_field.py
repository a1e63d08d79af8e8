"""A field for the time of day, typed as people write it."""

import re

from PySide6.QtCore import QEvent, Qt, QTime, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent, QWheelEvent
from PySide6.QtWidgets import QLineEdit

_SHOWN = "HH:mm:ss"
_WITH_MARKS = re.compile(r"(\d{1,2})(?:[:.h ](\d{1,2}))?(?:[:. ](\d{1,2}))? ?([ap])?\.?(?:m\.?)?")
_DIGITS_ALONE = re.compile(r"(\d{1,2})(\d{2})(\d{2})?")
_WIDTH_PX = 84


class ClockField(QLineEdit):
    """Enter or leaving submits the typed text; Escape restores the time; Up and Down step.

    Signals: `time_typed` (a `QTime`), `refused` (a sentence). `show_time` emits nothing.
    """

    time_typed = Signal(object)
    refused = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._time = QTime(0, 0)
        self.setFixedWidth(_WIDTH_PX)
        self.setToolTip(
            "Time of day, as 8:30, 2155 or 9 pm; Up and Down change what the cursor is in"
        )
        self.editingFinished.connect(self._hand_over)
        self.show_time(self._time)

    @property
    def time(self) -> QTime:
        """The time that was shown or handed over last."""
        return self._time

    def show_time(self, time: QTime) -> None:
        """Show a time, unless another one is being typed."""
        self._time = time
        # Selected text is about to be replaced by typing.
        if not self.isModified() and not self.hasSelectedText():
            place = self.cursorPosition()
            self.setText(time.toString(_SHOWN))
            self.setCursorPosition(place)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Select all when focused by keyboard, so that typing replaces it."""
        super().focusInEvent(event)
        if event.reason() in (Qt.FocusReason.TabFocusReason, Qt.FocusReason.BacktabFocusReason):
            self.selectAll()

    def event(self, event: QEvent) -> bool:
        """Take Escape before the window's shortcuts where something was typed."""
        if (
            event.type() == QEvent.Type.ShortcutOverride
            and isinstance(event, QKeyEvent)
            and event.key() == Qt.Key.Key_Escape
            and self.isModified()
        ):
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Escape restores the time; Up and Down step hours, minutes or seconds."""
        if event.key() == Qt.Key.Key_Escape:
            self._take_back()
        elif event.key() in (Qt.Key.Key_Up, Qt.Key.Key_Down):
            self._step(1 if event.key() == Qt.Key.Key_Up else -1)
        else:
            super().keyPressEvent(event)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Step what the cursor is in."""
        if self.hasFocus() and event.angleDelta().y():
            self._step(1 if event.angleDelta().y() > 0 else -1)

    def _hand_over(self) -> None:
        """Qt asks at each loss of focus too, also where nothing was typed."""
        if not self.isModified():
            return
        time = time_of(self.text())
        if time is None:
            self.refused.emit(f"'{self.text()}' is no time of day: write it as 8:30 or 21:55")
            self._take_back()
            return
        self._time = time
        self._take_back()
        self.time_typed.emit(time)

    def _take_back(self) -> None:
        self.deselect()
        self.setModified(False)
        self.show_time(self._time)

    def _step(self, steps: int) -> None:
        time = time_of(self.text()) or self._time
        # HH:mm:ss: two digits and a mark each.
        seconds = (3600, 60, 1)[min(self.cursorPosition() // 3, 2)]
        self._time = time.addSecs(steps * seconds)
        self._take_back()
        self.time_typed.emit(self._time)


def time_of(text: str) -> QTime | None:
    """The time that a text means: 8:30, 8.30, 8h30, 0830, 8, 9 pm, 21:55:10; None for none."""
    said = text.strip().lower()
    found = _DIGITS_ALONE.fullmatch(said) or _WITH_MARKS.fullmatch(said)
    if found is None:
        return None
    hour, minute, second = (int(part or 0) for part in found.groups()[:3])
    half = found[4] if found.re is _WITH_MARKS else None
    if half is not None:
        if not 1 <= hour <= 12:
            return None
        hour = hour % 12 + (12 if half == "p" else 0)
    time = QTime(hour, minute, second)
    return time if time.isValid() else None

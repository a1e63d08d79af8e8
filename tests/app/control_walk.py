"""Works every control of a window as a user would, and tells which did nothing."""

from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QComboBox,
    QFileDialog,
    QInputDialog,
    QLabel,
    QLineEdit,
    QPushButton,
    QSlider,
    QToolButton,
    QWidget,
)
from shiboken6 import isValid
from window_driver import PATIENCE_MS

from vrut_lite.app.panels.day_bar import DayBar
from vrut_lite.app.panels.world_map import WorldMap
from vrut_lite.messages.picture import Resize

_DRAWN = (DayBar, WorldMap)
_KINDS = (
    QAbstractButton, QAbstractItemView, QAbstractSpinBox, QComboBox, QLineEdit, QSlider, *_DRAWN,
)  # fmt: skip
_QUIET_MS, _MOST_LOOKS = 25, 40


def controls_of(panel):
    """What can be worked in a panel, without the parts that such things are made of."""
    found = [part for part in panel.findChildren(QWidget) if isinstance(part, _KINDS)]
    return [part for part in found if not _is_part(part)]


def _is_part(widget):
    parent = widget.parentWidget()
    while parent is not None:
        if isinstance(parent, (QComboBox, QAbstractSpinBox, QLineEdit, QAbstractItemView)):
            return True
        parent = parent.parentWidget()
    return widget.objectName().startswith("qt_")


def name_of(control):
    """What a person, or a test's report, calls a control."""
    text = control.text() if isinstance(control, QAbstractButton) else ""
    words = control.accessibleName() or text or control.toolTip().partition("\n")[0]
    parent = control.parentWidget()
    if not words and parent is not None:
        words = parent.accessibleName() or parent.toolTip().partition("\n")[0]
    return words


class ControlWalk:
    """`restless`: labels that change by themselves, and tell nothing of a control."""

    def __init__(self, driver, monkeypatch, restless=(), patience_ms=PATIENCE_MS):
        self.patience_ms = patience_ms
        self._driver, self._window = driver, driver.window
        self._restless = {
            part for widget in restless for part in (widget, *widget.findChildren(QWidget))
        }
        self._events = []
        session = driver.session
        session.sent.connect(self._note_input)
        session.problem.connect(lambda line: self._events.append(line))
        for dialog, methods in (
            (QFileDialog, ("getSaveFileName", "getOpenFileName")),
            (QInputDialog, ("getText",)),
        ):
            for method in methods:
                monkeypatch.setattr(dialog, method, self._asked)

    def _note_input(self, message):
        # The picture's size follows when a panel's has settled: that is no control's doing.
        if not isinstance(message, Resize):
            self._events.append(message)

    def _asked(self, *_):
        self._events.append("dialog")
        return "", False

    def has_effect(self, control):
        """Work it once; whether anything came of it."""
        before = self._quiet_look(control)
        if not (isValid(control) and control.isVisible() and control.isEnabled()):
            # Something before it has taken it away.
            return True
        self._events.clear()
        if not _work(self._driver.qtbot, control):
            return False
        try:
            self._driver.qtbot.waitUntil(
                lambda: bool(self._events) or self._look(control) != before,
                timeout=self.patience_ms,
            )
        except Exception:
            return False
        return True

    def let_go(self, control):
        """Release what stays pressed: playing, paused, in safe mode nothing else is as it was."""
        pressed = isValid(control) and isinstance(control, QPushButton | QToolButton)
        if pressed and control.isCheckable() and control.isChecked():
            control.click()
        self._driver.settled()
        self._driver.qtbot.wait(_QUIET_MS)

    def _quiet_look(self, control):
        """What is seen when all that came of the control before has come."""
        self._driver.settled()
        look = self._look(control)
        for _ in range(_MOST_LOOKS):
            self._driver.qtbot.wait(_QUIET_MS)
            last, look = look, self._look(control)
            if look == last:
                break
        return look

    def _look(self, control):
        """All that can be seen, but for the control itself and what is around it."""
        own = {control, *control.findChildren(QWidget)} if isValid(control) else set()
        looks = {}
        for widget in self._window.findChildren(QWidget):
            if widget not in own | self._restless:
                looks[widget] = (widget.isVisible(), widget.isEnabled(), _text(widget))
        return looks


def _text(widget):
    if isinstance(widget, (QLabel, QLineEdit, QAbstractButton)):
        return widget.text()
    if isinstance(widget, QAbstractItemView):
        model = widget.model()
        return None if model is None else (model.rowCount(), widget.currentIndex().row())
    return None


def _work(qtbot, control):
    """One act of a user; false where there is nothing to choose from."""
    if isinstance(control, _DRAWN):
        spot = QPoint(round(0.3 * control.width()), control.height() // 2)
        qtbot.mouseClick(control, Qt.MouseButton.LeftButton, pos=spot)
    elif isinstance(control, QPushButton | QToolButton) and control.menu() is not None:
        control.menu().aboutToShow.emit()
        actions = [action for action in control.menu().actions() if action.isEnabled()]
        actions[-1].trigger()
    elif isinstance(control, QAbstractButton):
        control.click()
    elif isinstance(control, QComboBox):
        return _choose_another(qtbot, control)
    elif isinstance(control, QAbstractSpinBox):
        up = control.stepEnabled() & QAbstractSpinBox.StepEnabledFlag.StepUpEnabled
        qtbot.keyClick(control, Qt.Key.Key_Up if up else Qt.Key.Key_Down)
    elif isinstance(control, QSlider):
        at_end = control.value() == control.maximum()
        qtbot.keyClick(control, Qt.Key.Key_PageDown if at_end else Qt.Key.Key_PageUp)
    elif isinstance(control, QLineEdit):
        qtbot.keyClicks(control, "a")
        qtbot.keyClick(control, Qt.Key.Key_Return)
    elif isinstance(control, QAbstractItemView):
        before = control.currentIndex()
        qtbot.keyClick(control, Qt.Key.Key_End)
        if control.currentIndex() == before:
            qtbot.keyClick(control, Qt.Key.Key_Home)
        qtbot.keyClick(control, Qt.Key.Key_Return)
    return True


def _choose_another(qtbot, box):
    last = box.currentIndex() == box.count() - 1
    qtbot.keyClick(box, Qt.Key.Key_Up if last else Qt.Key.Key_Down)
    return box.count() > 1

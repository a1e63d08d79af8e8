"""Decides whether a key goes to the focused control or to the window's shortcuts.

Qt lets shortcuts win over the keys of buttons and lists, and lets a text field take Ctrl+Z even if
nothing was typed in it.
"""

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent, QKeySequence
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QComboBox,
    QDoubleSpinBox,
    QLineEdit,
    QSpinBox,
    QWidget,
)

from vrut_lite.app.panels.module_panel import ModulePanel

_TAKING_BACK = (QKeySequence.StandardKey.Undo, QKeySequence.StandardKey.Redo)
_ENTER = (Qt.Key.Key_Return, Qt.Key.Key_Enter)
_PLAIN = (Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.KeypadModifier)


class KeyJudge(QObject):
    """Filters key events of the controls in panels."""

    def watch(self, panel: QWidget) -> None:
        """Filter the keys of all controls in a panel, also of those that are added later."""
        for control in (panel, *panel.findChildren(QWidget)):
            if isinstance(control, _CONTROLS):
                control.installEventFilter(self)
            elif isinstance(control, ModulePanel):
                control.remade.connect(self.watch)

    def eventFilter(self, control: QObject, event: QEvent) -> bool:
        """Qt asks whether a control wants a key for itself before it tries shortcuts."""
        if not isinstance(event, QKeyEvent):
            return False
        if event.type() == QEvent.Type.KeyPress:
            return _opens(control, event)
        if event.type() != QEvent.Type.ShortcutOverride:
            return False
        if any(event.matches(key) for key in _TAKING_BACK):
            if _has_typed(control):
                return False
            event.ignore()
            return True
        if event.modifiers() in _PLAIN:
            if _uses(control, event):
                event.accept()
                return True
            if _leaves(control, event):
                event.ignore()
                return True
        return False


_CONTROLS = (QAbstractItemView, QComboBox, QAbstractButton, QAbstractSpinBox, QLineEdit)
_NUMBERS = (QSpinBox, QDoubleSpinBox)


def _opens(control: QObject, event: QKeyEvent) -> bool:
    """Enter opens a closed drop-down; in an open one it chooses, which Qt sees to."""
    if not isinstance(control, QComboBox) or event.key() not in _ENTER:
        return False
    control.showPopup()
    return True


def _uses(control: QObject, event: QKeyEvent) -> bool:
    """Space presses buttons; letters go to an entry of a list, also of an open drop-down."""
    if isinstance(control, QAbstractButton):
        return event.key() == Qt.Key.Key_Space
    # Qt chooses in an open drop-down when it is asked who wants Enter: it must hear of it.
    return (
        isinstance(control, QAbstractItemView) and bool(event.text()) and event.key() not in _ENTER
    )


def _leaves(control: QObject, event: QKeyEvent) -> bool:
    """A closed drop-down leaves Space and letters to the window, a field of numbers letters."""
    if isinstance(control, QComboBox):
        return event.text().isprintable() and bool(event.text())
    return isinstance(control, _NUMBERS) and event.text().isalpha()


def _has_typed(control: QObject) -> bool:
    """Whether something was typed that the control itself can undo."""
    line = control if isinstance(control, QLineEdit) else control.findChild(QLineEdit)
    return line is not None and line.isUndoAvailable() and line.isModified()

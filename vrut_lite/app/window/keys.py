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
    QLineEdit,
    QWidget,
)

from vrut_lite.app.panels.module_panel import ModulePanel

_TAKING_BACK = (QKeySequence.StandardKey.Undo, QKeySequence.StandardKey.Redo)
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
        if event.type() != QEvent.Type.ShortcutOverride or not isinstance(event, QKeyEvent):
            return False
        if any(event.matches(key) for key in _TAKING_BACK):
            if _has_typed(control):
                return False
            event.ignore()
            return True
        if event.modifiers() in _PLAIN and _uses(control, event):
            event.accept()
            return True
        return False


_CHOOSERS = (QAbstractItemView, QComboBox)
_CONTROLS = (*_CHOOSERS, QAbstractButton, QAbstractSpinBox, QLineEdit)


def _uses(control: QObject, event: QKeyEvent) -> bool:
    """Space presses buttons; a letter selects an entry of a list or chooser."""
    if isinstance(control, QAbstractButton):
        return event.key() == Qt.Key.Key_Space
    return isinstance(control, _CHOOSERS) and bool(event.text())


def _has_typed(control: QObject) -> bool:
    """Whether something was typed that the control itself can undo."""
    line = control if isinstance(control, QLineEdit) else control.findChild(QLineEdit)
    return line is not None and line.isUndoAvailable() and line.isModified()

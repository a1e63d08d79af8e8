"""The command palette: every action by a few letters of its name."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtGui import QColor, QKeyEvent
from PySide6.QtWidgets import (
    QDialog,
    QHeaderView,
    QLineEdit,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
)

from vrut_lite.app import theme
from vrut_lite.app.window.palette_entries import entries_of, matching

if TYPE_CHECKING:
    from vrut_lite.app.window.main_window import MainWindow

_WIDTH_PX, _HEIGHT_PX, _TOP_PX = 520, 380, 70
_MOVING = (Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_PageUp, Qt.Key.Key_PageDown)


class CommandPalette(QDialog):
    """A text field above the matching commands; arrows move, Enter runs one, Escape closes."""

    def __init__(self, window: "MainWindow"):
        super().__init__(window, Qt.WindowType.Popup)
        self._window = window
        self._entries = entries_of(window)
        self.found = self._entries
        self.text_field = QLineEdit()
        self.text_field.setPlaceholderText("What is to be done?")
        self.text_field.setAccessibleName("command")
        self.list = QTreeWidget()
        self.list.setAccessibleName("commands")
        self.list.setHeaderHidden(True)
        self.list.setRootIsDecorated(False)
        self.list.setUniformRowHeights(True)
        self.list.setColumnCount(2)
        self.list.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        header = self.list.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(1, QHeaderView.ResizeMode.ResizeToContents)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        column = QVBoxLayout(self)
        column.addWidget(self.text_field)
        column.addWidget(self.list)
        self.setStyleSheet(f"QDialog {{ border: 1px solid {theme.LINE}; }}")
        self.text_field.installEventFilter(self)
        self.text_field.textChanged.connect(self._search)
        self.text_field.returnPressed.connect(self._run)
        self.list.itemClicked.connect(lambda *_: self._run())
        self._search("")
        self._place()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Arrows move through the list while the text field has the focus."""
        if (
            event.type() == QEvent.Type.KeyPress
            and isinstance(event, QKeyEvent)
            and event.key() in _MOVING
        ):
            self.list.keyPressEvent(event)
            return True
        return False

    def _place(self) -> None:
        corner = self._window.mapToGlobal(self._window.rect().topLeft())
        self.resize(min(_WIDTH_PX, self._window.width() - 40), _HEIGHT_PX)
        self.move(corner.x() + (self._window.width() - self.width()) // 2, corner.y() + _TOP_PX)

    def _search(self, text: str) -> None:
        self.found = matching(self._entries, text)
        self.list.clear()
        for entry in self.found:
            item = QTreeWidgetItem(self.list, [entry.title, entry.hint])
            item.setForeground(1, QColor(theme.FAINT))
        self.list.setCurrentIndex(self.list.model().index(0, 0))

    def _run(self) -> None:
        place = self.list.currentIndex().row()
        self.accept()
        if 0 <= place < len(self.found):
            # The command may open a dialog of its own, so this one is closed first.
            QTimer.singleShot(0, self._window, self.found[place].act)

"""The list of all keys: those of the menus and those of the picture."""

from collections.abc import Iterator

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor
from PySide6.QtWidgets import (
    QDialog,
    QHeaderView,
    QLineEdit,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from vrut_lite.app import theme
from vrut_lite.app.window.actions import ActionSpec

_IN_PICTURE = (
    ("Drag", "turn, or look around"),
    ("Right drag, Shift and drag", "shift the view"),
    ("Wheel, + \N{MINUS SIGN}", "nearer; the view's angle in flight; climb from the ground"),
    ("Arrows", "turn, or look around"),
    ("W A S D, E Q", "fly; up and down; Shift for faster"),
    ("Page Up, Page Down", "climb and come down"),
)
_ANYWHERE = (
    ("Tab, Shift+Tab", "the next control, the one before"),
    ("Alt and a letter", "menus"),
    ("Up, Down, Page Up, Page Down", "a control's value by a little, by more"),
    ("Enter in a drop-down", "opens it, and chooses"),
    ("Left, Right in the day", "a few minutes earlier or later"),
)


class ShortcutList(QDialog):
    """Type to find a key or its action."""

    def __init__(self, actions: list[ActionSpec], parent: QWidget | None = None):
        super().__init__(parent)
        self.setWindowTitle("Keys")
        self.filter = QLineEdit()
        self.filter.setPlaceholderText("Find a key, or what it does")
        self.filter.setAccessibleName("filter of keys")
        self.list = QTreeWidget()
        self.list.setAccessibleName("keys")
        self.list.setHeaderHidden(True)
        self.list.setColumnCount(2)
        self.list.header().setSectionResizeMode(0, QHeaderView.ResizeMode.ResizeToContents)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        column = QVBoxLayout(self)
        column.addWidget(self.filter)
        column.addWidget(self.list)
        self.resize(560, 560)
        self._lines: dict[str, tuple[QTreeWidgetItem, list[QTreeWidgetItem]]] = {}
        for section, lines in _sections(actions):
            heading = QTreeWidgetItem(self.list, [section])
            heading.setForeground(0, QColor(theme.ACCENT))
            self._lines[section] = (heading, [QTreeWidgetItem(heading, line) for line in lines])
        self.list.expandAll()
        self.filter.textChanged.connect(self._search)

    def _search(self, text: str) -> None:
        words = text.lower().split()
        for heading, lines in self._lines.values():
            for line in lines:
                text_of_line = f"{line.text(0)} {line.text(1)}".lower()
                line.setHidden(not all(word in text_of_line for word in words))
            heading.setHidden(all(line.isHidden() for line in lines))


def _sections(actions: list[ActionSpec]) -> Iterator[tuple[str, list[tuple[str, str]]]]:
    menus = dict.fromkeys(spec.menu for spec in actions)
    for menu in menus:
        yield menu, [(s.keys, s.title) for s in actions if s.menu == menu and s.keys]
    yield "In the picture", list(_IN_PICTURE)
    yield "Anywhere", list(_ANYWHERE)

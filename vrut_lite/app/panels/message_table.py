"""Messages in a table that can be filtered."""

from bisect import bisect_left
from typing import Any

from PySide6.QtCore import (
    QAbstractTableModel,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    Qt,
    Signal,
)
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QHeaderView, QTreeView

from vrut_lite.app import theme
from vrut_lite.app.engine.message_rows import MessageRow

# Number of live messages kept; a journal is shown whole.
MOST_LIVE = 5000
_TITLES = ("No.", "Message", "From", "To", "ms")
_WIDTHS = (46, 132, 96, 80, 44)
_OF_DELIVERIES = (3, 4)
Index = QModelIndex | QPersistentModelIndex
_ROOT = QModelIndex()


class MessageModel(QAbstractTableModel):
    """Rows in order of their numbers; of these, those that hold the words of a filter."""

    def __init__(self, parent: QObject | None) -> None:
        super().__init__(parent)
        self._rows: list[MessageRow] = []
        self._shown: list[MessageRow] = []
        self._words: list[str] = []

    @property
    def rows(self) -> list[MessageRow]:
        """All rows, also those that the filter hides."""
        return self._rows

    @property
    def shown(self) -> list[MessageRow]:
        """The rows that pass the filter."""
        return self._shown

    def replace(self, rows: list[MessageRow]) -> None:
        """Replace the rows."""
        self._rows = rows
        self._filter()

    def append(self, rows: list[MessageRow]) -> None:
        """Append rows; the oldest are dropped beyond the limit."""
        if len(self._rows) + len(rows) > MOST_LIVE:
            self.replace(with_latest(self._rows, rows))
            return
        self._rows.extend(rows)
        passing = [row for row in rows if self._passes(row)]
        if passing:
            first = len(self._shown)
            self.beginInsertRows(_ROOT, first, first + len(passing) - 1)
            self._shown.extend(passing)
            self.endInsertRows()

    def set_filter(self, text: str) -> None:
        """Show the rows with all these words in type, sender or receivers."""
        self._words = text.lower().split()
        self._filter()

    def row_of(self, number: int) -> MessageRow | None:
        """The message of this number, shown or not."""
        place = bisect_left(self._rows, number, key=lambda row: row.number)
        found = self._rows[place : place + 1]
        return found[0] if found and found[0].number == number else None

    def index_of(self, number: int) -> QModelIndex:
        """The index of a shown message; invalid if it is hidden."""
        place = bisect_left(self._shown, number, key=lambda row: row.number)
        found = self._shown[place : place + 1]
        return self.index(place, 0) if found and found[0].number == number else QModelIndex()

    def _passes(self, row: MessageRow) -> bool:
        return all(word in row.searched for word in self._words)

    def _filter(self) -> None:
        self.beginResetModel()
        self._shown = [row for row in self._rows if self._passes(row)]
        self.endResetModel()

    # --- what Qt asks ------------------------------------------------------------------------

    def rowCount(self, parent: Index = _ROOT) -> int:
        """How many are shown."""
        return 0 if parent.isValid() else len(self._shown)

    def columnCount(self, parent: Index = _ROOT) -> int:
        """As many as there are titles."""
        return 0 if parent.isValid() else len(_TITLES)

    def headerData(
        self, section: int, way: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        """The titles."""
        if role == Qt.ItemDataRole.DisplayRole and way == Qt.Orientation.Horizontal:
            return _TITLES[section]
        return None

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Texts; inputs stand out."""
        row = self._shown[index.row()]
        if role == Qt.ItemDataRole.DisplayRole:
            return _texts(row)[index.column()]
        if role == Qt.ItemDataRole.ForegroundRole:
            return colour_of(row)
        if role == Qt.ItemDataRole.TextAlignmentRole and index.column() in (0, 4):
            return int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        return None


class MessageTable(QTreeView):
    """`chosen` emits the number of the current row."""

    chosen = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.messages = MessageModel(self)
        self.setModel(self.messages)
        self.setAccessibleName("messages")
        self.setRootIsDecorated(False)
        self.setUniformRowHeights(True)
        header = self.header()
        header.setStretchLastSection(False)
        for column, width in enumerate(_WIDTHS):
            header.resizeSection(column, width)
        self.show_deliveries(True)
        self.selectionModel().currentChanged.connect(self._moved)

    def go_to(self, number: int) -> None:
        """Choose a message, if it is shown."""
        index = self.messages.index_of(number)
        if index.isValid():
            self.setCurrentIndex(index)
            self.scrollTo(index)

    def show_deliveries(self, shown: bool) -> None:
        """Show or hide receivers and times, which a journal does not hold."""
        for column in _OF_DELIVERIES:
            self.setColumnHidden(column, not shown)
        stretched = 3 if shown else 2
        for column in (2, 3):
            mode = QHeaderView.ResizeMode
            self.header().setSectionResizeMode(
                column, mode.Stretch if column == stretched else mode.Interactive
            )

    def append(self, rows: list[MessageRow]) -> None:
        """Add rows; a table that stood at its end follows them."""
        bar = self.verticalScrollBar()
        at_end = bar.value() >= bar.maximum() - 2
        self.messages.append(rows)
        if at_end:
            self.scrollToBottom()

    def _moved(self, current: QModelIndex) -> None:
        if current.isValid():
            self.chosen.emit(self.messages.shown[current.row()].number)


def with_latest(rows: list[MessageRow], more: list[MessageRow]) -> list[MessageRow]:
    """Live rows and newer ones; beyond the limit the oldest quarter is dropped."""
    both = [*rows, *more]
    return both if len(both) <= MOST_LIVE else both[-MOST_LIVE * 3 // 4 :]


def colour_of(row: MessageRow) -> QColor:
    """Inputs in the accent colour, faults in the alarm colour."""
    if row.type_name == "Fault":
        return QColor(theme.ALARM)
    return QColor(theme.ACCENT if row.is_input else theme.TEXT)


def _texts(row: MessageRow) -> tuple[str, ...]:
    ms = "" if row.ms is None else f"{row.ms:.1f}"
    return str(row.number), row.type_name, row.sender, ", ".join(row.receivers), ms

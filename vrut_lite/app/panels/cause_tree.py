"""The causes and effects of a message."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHeaderView, QTreeWidget, QTreeWidgetItem

from vrut_lite.app.engine.message_rows import MessageRow
from vrut_lite.app.panels.message_table import MessageModel, colour_of

_NUMBER = Qt.ItemDataRole.UserRole
_MOST_EFFECTS = 400


class CauseTree(QTreeWidget):
    """The whole transaction of a message, from its input on; `gone_to` emits a number."""

    gone_to = Signal(int)

    def __init__(self, messages: MessageModel):
        super().__init__()
        self._messages = messages
        self.setAccessibleName("what caused this")
        self.setHeaderLabels(["Causes and effects of the message", "From"])
        self.setUniformRowHeights(True)
        header = self.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.itemActivated.connect(lambda item, _: self.gone_to.emit(item.data(0, _NUMBER)))

    def show_message(self, number: int) -> None:
        """Draw the transaction of a message and mark the message in it."""
        self.clear()
        chain = causes_of(self._messages, number)
        if not chain:
            return
        items = {chain[0].number: self._item(self, chain[0])}
        for row in effects_of(self._messages, chain[0].number):
            items[row.number] = self._item(items[row.cause], row)
        self.expandAll()
        if number in items:
            self.setCurrentItem(items[number])

    def _item(self, parent: "CauseTree | QTreeWidgetItem", row: MessageRow) -> QTreeWidgetItem:
        item = QTreeWidgetItem(parent, [row.type_name, row.sender])
        item.setData(0, _NUMBER, row.number)
        item.setForeground(0, colour_of(row))
        return item


def causes_of(messages: MessageModel, number: int) -> list[MessageRow]:
    """The message after all its known causes, the first cause first."""
    chain: list[MessageRow] = []
    row = messages.row_of(number)
    while row is not None:
        chain.insert(0, row)
        row = messages.row_of(row.cause) if row.cause else None
    return chain


def effects_of(messages: MessageModel, number: int) -> list[MessageRow]:
    """All effects of a message, direct or not, in order of delivery."""
    family = {number}
    effects: list[MessageRow] = []
    first = next((i for i, row in enumerate(messages.rows) if row.number == number), 0)
    for row in messages.rows[first + 1 :]:
        if row.is_input:
            # A transaction ends where the next begins.
            break
        if row.cause in family and len(effects) < _MOST_EFFECTS:
            family.add(row.number)
            effects.append(row)
    return effects

"""The message inspector: messages of the modules, live or from a journal."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import (
    QHBoxLayout,
    QHeaderView,
    QLineEdit,
    QPushButton,
    QSplitter,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from vrut_lite.app.engine.message_rows import MessageRow, MessageWatch
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.panels.cause_tree import CauseTree
from vrut_lite.app.panels.journal_bar import JournalBar
from vrut_lite.app.panels.message_table import MessageTable, with_latest
from vrut_lite.app.widgets import make_timer, panel_column

_LOOK_MS = 250


class MessageInspector(QWidget):
    """A table of messages; below, causes, effects and fields of the chosen one.

    Nothing is watched while the panel is hidden or paused.
    """

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self._watch: MessageWatch | None = None
        self._live: list[MessageRow] = []
        self._asking = False
        self._clears = 0
        self._make_parts()
        self._lay_out()
        self._looking = make_timer(self, _LOOK_MS, self._look)
        self.filter.textChanged.connect(self.table.messages.set_filter)
        self.pause.toggled.connect(self._pause)
        self.clear.clicked.connect(self._clear)
        self.table.chosen.connect(self._show_message)
        self.causes.gone_to.connect(self._go_to)
        self.journal.opened.connect(self._show_journal)
        self.journal.closed.connect(self._show_live)
        self.journal.stepped.connect(self.table.go_to)
        session.ready.connect(lambda _: self._set_watching())
        session.ended.connect(self._looking.stop)

    # --- widgets -----------------------------------------------------------------------------

    def _make_parts(self) -> None:
        self.filter = QLineEdit()
        self.filter.setPlaceholderText("Words of a type, a sender, a receiver")
        self.filter.setClearButtonEnabled(True)
        self.filter.setAccessibleName("filter of messages")
        self.pause = QPushButton("Pause")
        self.pause.setCheckable(True)
        self.pause.setToolTip("Do not show new messages")
        self.clear = QPushButton("Clear")
        self.clear.setToolTip("Empty the list")
        self.table = MessageTable()
        self.causes = CauseTree(self.table.messages)
        self.content = QTreeWidget()
        self.content.setAccessibleName("content of the message")
        self.content.setHeaderLabels(["Field", "Value"])
        self.content.setRootIsDecorated(False)
        self.content.header().setSectionResizeMode(0, QHeaderView.ResizeMode.ResizeToContents)
        self.journal = JournalBar(self._session)

    def _lay_out(self) -> None:
        top = QHBoxLayout()
        for part in (self.filter, self.pause, self.clear):
            top.addWidget(part)
        halves = QSplitter(Qt.Orientation.Vertical)
        for place, view in enumerate((self.table, self.causes, self.content)):
            halves.addWidget(view)
            halves.setStretchFactor(place, 2 if place else 3)
        column = panel_column(self)
        column.addLayout(top)
        column.addWidget(halves, 1)
        column.addWidget(self.journal)

    # --- watching ----------------------------------------------------------------------------

    def showEvent(self, event: QShowEvent) -> None:
        """Start to watch."""
        self._set_watching()

    def hideEvent(self, event: QHideEvent) -> None:
        """Stop watching."""
        self._set_watching()

    @property
    def _wishes_to_watch(self) -> bool:
        return self.isVisible() and not self.pause.isChecked()

    def _pause(self, paused: bool) -> None:
        self._set_watching()

    def _set_watching(self) -> None:
        wished = self._wishes_to_watch
        if not self._session.catalogue.modules or (self._watch is None and not wished):
            return
        self._session.ask(lambda stage: self._switch(stage, wished))
        if wished:
            self._looking.start()
        else:
            self._looking.stop()
            # Messages seen before the switch are shown now, not after the next switch.
            self._ask_for_rows()

    def _switch(self, stage: Stage, watching: bool) -> None:
        """On the engine's thread."""
        if self._watch is None:
            self._watch = MessageWatch(stage.kernel)
        self._watch.watching = watching

    def _look(self) -> None:
        if not self._asking:
            self._ask_for_rows()

    def _ask_for_rows(self) -> None:
        watch, clears = self._watch, self._clears
        if watch is not None:
            self._asking = True
            self._session.ask(lambda stage: watch.take(), lambda rows: self._take(rows, clears))

    def _take(self, rows: list[MessageRow], clears: int) -> None:
        self._asking = False
        if clears != self._clears:
            return
        if rows and self.journal.is_open:
            self._live = with_latest(self._live, rows)
        elif rows:
            self.table.append(rows)

    # --- showing -----------------------------------------------------------------------------

    def _clear(self) -> None:
        """Empty the list; rows on their way do not come back."""
        self._clears += 1
        if (watch := self._watch) is not None:
            self._session.ask(lambda stage: watch.take())
        self._live.clear()
        self.table.messages.replace([])
        self._show_message(0)

    def _show_message(self, number: int) -> None:
        self.causes.show_message(number)
        self.content.clear()
        row = self.table.messages.row_of(number)
        for name, text in row.fields if row is not None else ():
            item = QTreeWidgetItem(self.content, [name, text])
            item.setToolTip(1, text)

    def _go_to(self, number: int) -> None:
        """Go to a message, also to one that the filter hides."""
        if self.table.messages.index_of(number).isValid():
            self.table.go_to(number)
        else:
            self._show_message(number)

    def _show_journal(self, rows: list[MessageRow]) -> None:
        self._live = self.table.messages.rows
        self.table.show_deliveries(False)
        self.table.messages.replace(rows)
        self._show_message(0)

    def _show_live(self) -> None:
        self.table.show_deliveries(True)
        self.table.messages.replace(self._live)
        self._live = []
        self._show_message(0)

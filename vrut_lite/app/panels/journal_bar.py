"""Saving the session as a journal, opening one, and stepping through its inputs."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QFileDialog,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from vrut_lite.app.engine.flight_recorder import Recorded
from vrut_lite.app.engine.message_rows import OpenJournal, open_journal
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.widgets import faint_label, make_timer
from vrut_lite.kernel.messages import JobResult
from vrut_lite.message_codec import decode
from vrut_lite.recording.registry import Registry

_FILES = "Journals (*.mcap)"
_COUNT_MS = 500


class JournalBar(QWidget):
    """Signals: `opened` (the rows of a journal), `closed` (back to live messages), `stepped`
    (the number of the input).
    """

    opened = Signal(object)
    closed = Signal()
    stepped = Signal(int)

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self._saved_as = ""
        self._journal: OpenJournal | None = None
        self._inputs: list[int] = []
        self._at = -1
        self._reader = ThreadPoolExecutor(1, "vrut-lite journal reader")
        self._make_parts()
        self._lay_out()
        self._show_mode()
        make_timer(self, _COUNT_MS, self._show_recorded).start()
        session.ended.connect(lambda: self._reader.shutdown(wait=False, cancel_futures=True))

    def _make_parts(self) -> None:
        self.recorded = faint_label(wraps=True)
        self.save = _button(
            "Save journal\N{HORIZONTAL ELLIPSIS}",
            "Write all inputs since the window opened, for `vrut-lite replay`",
            self._ask_to_save,
        )
        self.open = _button(
            "Open journal\N{HORIZONTAL ELLIPSIS}",
            "Show a recorded journal, message by message",
            self._ask_to_open,
        )
        self.name = QLabel()
        self.back = _button("Back", "The input before", partial(self.step, -1))
        self.next = _button("Step", "The next input and its effects", partial(self.step, 1))
        self.play = QCheckBox("in the window")
        self.play.setToolTip("Also send each input to this window")
        self.close_journal = _button("Close", "Back to live messages", self.leave)

    def _lay_out(self) -> None:
        first, second = QHBoxLayout(), QHBoxLayout()
        first.addWidget(self.recorded, 1)
        first.addWidget(self.save)
        first.addWidget(self.open)
        self._stepper = QWidget()
        self._stepper.setLayout(second)
        second.setContentsMargins(0, 0, 0, 0)
        second.addWidget(self.name, 1)
        steps: tuple[QWidget, ...] = (self.back, self.next, self.play, self.close_journal)
        for part in steps:
            second.addWidget(part)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(first)
        column.addWidget(self._stepper)

    # --- actions -----------------------------------------------------------------------------

    @property
    def is_open(self) -> bool:
        """Whether a journal is shown."""
        return self._journal is not None

    def save_to(self, path: str) -> None:
        """Write the journal of this session."""
        self._session.save_journal(path, partial(self._saved, path), self._session.refused.emit)

    def open_from(self, path: str) -> None:
        """Read a journal, on a separate thread."""
        read = self._reader.submit(open_journal, path)
        self._session.follow(read, self._opened, self._session.refused.emit)

    def step(self, by: int) -> None:
        """Go to the next input or the one before; with `play` checked, send it to this window."""
        self._at = min(max(self._at + by, 0), len(self._inputs) - 1)
        self._show_mode()
        number = self._inputs[self._at]
        self.stepped.emit(number)
        opened = self._journal
        if self.play.isChecked() and opened is not None:
            self._session.ask(lambda stage: _do(stage, opened, number))

    def leave(self) -> None:
        """Close the journal."""
        self._journal, self._inputs, self._at = None, [], -1
        self._show_mode()
        self.closed.emit()

    def _ask_to_save(self) -> None:
        path, _ = QFileDialog.getSaveFileName(self, "Save journal", "session.mcap", _FILES)
        if path:
            self.save_to(path)

    def _ask_to_open(self) -> None:
        path, _ = QFileDialog.getOpenFileName(self, "Open journal", "", _FILES)
        if path:
            self.open_from(path)

    # --- display -----------------------------------------------------------------------------

    def _opened(self, opened: OpenJournal) -> None:
        self._journal, self._inputs, self._at = opened, list(opened.inputs), -1
        self._show_mode()
        self.opened.emit(opened.rows)

    def _saved(self, path: str, recorded: Recorded) -> None:
        self._saved_as = f", {recorded.inputs:,} of them in {Path(path).name}"
        self._show_recorded()

    def _show_recorded(self) -> None:
        if not self.isVisible():
            return
        recorded = self._session.recorded
        text = recorded.ended or f"{recorded.inputs:,} inputs recorded"
        self.recorded.setText(text + self._saved_as)

    def _show_mode(self) -> None:
        self._stepper.setVisible(self.is_open)
        self.back.setEnabled(self._at > 0)
        self.next.setEnabled(self._at < len(self._inputs) - 1)
        if self._journal is not None:
            at = f"input {self._at + 1} of {len(self._inputs)}" if self._at >= 0 else "opened"
            self.name.setText(f"{self._journal.journal.path.name}: {at}")


def _do(stage: Stage, opened: OpenJournal, number: int) -> None:
    """Inject the journal's input; results of jobs come from the jobs of this window."""
    entry = opened.inputs[number]
    if entry.type_name != JobResult.__name__:
        registry = Registry(seat.module_type for seat in stage.kernel.seats.values())
        kind = registry.find_input(entry.type_name)
        stage.kernel.inject(decode(kind, entry.message, opened.journal.array))


def _button(text: str, tip: str, act: Callable[[], None]) -> QPushButton:
    button = QPushButton(text)
    button.setToolTip(tip)
    button.clicked.connect(lambda: act())
    return button

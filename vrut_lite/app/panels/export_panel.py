"""Exports: the picture that is shown, and pictures of a whole day."""

from collections.abc import Callable
from concurrent.futures import Executor
from datetime import timedelta
from pathlib import Path

from PySide6.QtWidgets import (
    QFileDialog,
    QHBoxLayout,
    QProgressBar,
    QPushButton,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from vrut_lite.app.engine.day_scout import DayScout
from vrut_lite.app.engine.export import FORMATS, export_picture
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.session_project import project_of
from vrut_lite.app.panels.day_sequence import DaySequence, instants_of, one_process
from vrut_lite.app.widgets import aligned_form, faint_label
from vrut_lite.errors import UserError
from vrut_lite.pictures.image_files import picture_format

_FILES = "Pictures (*.png *.exr)"


class ExportPanel(QWidget):
    """`open_workers` makes the process that draws the pictures of a day."""

    def __init__(
        self,
        session: Session,
        scout: DayScout,
        open_workers: Callable[[], Executor] = one_process,
    ):
        super().__init__()
        self._session, self._scout = session, scout
        self._open_workers = open_workers
        self.sequence: DaySequence | None = None
        self.picture = QPushButton("Export this picture\N{HORIZONTAL ELLIPSIS}")
        self.picture.setToolTip("PNG as shown, EXR of linear radiance in W m-2 sr-1")
        self.step_minutes = QSpinBox()
        self.step_minutes.setAccessibleName("minutes from picture to picture")
        self.step_minutes.setRange(1, 120)
        self.step_minutes.setValue(20)
        self.step_minutes.setSuffix(" min")
        self.day = QPushButton("Pictures of the day\N{HORIZONTAL ELLIPSIS}")
        self.day.setToolTip("From civil dawn to civil dusk, numbered files; the window goes on")
        self.progress = QProgressBar()
        self.progress.setFormat("%v of %m")
        self.cancel = QPushButton("Cancel")
        self.status = faint_label(wraps=True)
        self._lay_out()
        self._show_running(False)
        self.picture.clicked.connect(self._ask_for_picture)
        self.day.clicked.connect(self._ask_for_day)
        self.cancel.clicked.connect(self.stop)
        session.ended.connect(self.stop)

    def export(self, path: str) -> None:
        """Write the picture that is shown, in full size."""
        export_picture(self._session, path, self._tell)

    def start(self, path: str) -> None:
        """Make the pictures of the day, numbered before the suffix of their name."""
        day = self._scout.day
        if day is None or (self.sequence is not None and self.sequence.running):
            return
        instants = instants_of(day, timedelta(minutes=self.step_minutes.value()))
        sequence = DaySequence(
            project_of(self._session), instants, Path(path), self, self._open_workers
        )
        sequence.progressed.connect(self._show_progress)
        sequence.finished.connect(self._ended)
        sequence.failed.connect(self._failed)
        try:
            picture_format(path, FORMATS)
            sequence.start()
        except UserError as error:
            self._session.problem.emit(str(error))
            return
        self.sequence = sequence
        self._show_progress(0, len(instants))
        self._show_running(True)

    def stop(self) -> None:
        """Stop after the picture that is being made."""
        if self.sequence is not None:
            self.sequence.cancel()

    def _lay_out(self) -> None:
        form = aligned_form()
        form.addRow("A picture each", self.step_minutes)
        row = QHBoxLayout()
        row.addWidget(self.progress, 1)
        row.addWidget(self.cancel)
        column = QVBoxLayout(self)
        column.setContentsMargins(10, 10, 10, 10)
        column.addWidget(self.picture)
        column.addSpacing(10)
        column.addLayout(form)
        column.addWidget(self.day)
        column.addLayout(row)
        column.addWidget(self.status)
        column.addStretch(1)

    def _ask_for_picture(self) -> None:
        path, _ = QFileDialog.getSaveFileName(self, "Export picture", "", _FILES)
        if path:
            self.export(path)

    def _ask_for_day(self) -> None:
        path, _ = QFileDialog.getSaveFileName(self, "Pictures of the day", "day.png", _FILES)
        if path:
            self.start(path)

    def _show_progress(self, done: int, total: int) -> None:
        self.progress.setMaximum(total)
        self.progress.setValue(done)

    def _show_running(self, running: bool) -> None:
        self.day.setEnabled(not running)
        self.cancel.setVisible(running)
        self.progress.setVisible(running)

    def _ended(self, line: str) -> None:
        self._show_running(False)
        self._tell(line)

    def _failed(self, line: str) -> None:
        self._show_running(False)
        self._session.problem.emit(line)

    def _tell(self, line: str) -> None:
        self.status.setText(line)

"""Exports: the picture that is shown, pictures of many hours of a day, and films of them."""

from collections.abc import Callable
from concurrent.futures import Executor
from datetime import datetime, timedelta
from pathlib import Path

import msgspec
from PySide6.QtCore import QTime
from PySide6.QtWidgets import (
    QFileDialog,
    QHBoxLayout,
    QProgressBar,
    QPushButton,
    QSpinBox,
    QToolButton,
    QWidget,
)

from vrut_lite.app.engine.day import Day
from vrut_lite.app.engine.export import export_picture
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.session_project import folder_of, project_of
from vrut_lite.app.engine.sun_day_finder import SunDayFinder
from vrut_lite.app.icons import put_sign
from vrut_lite.app.panels.clock_field import ClockField
from vrut_lite.app.panels.day_sequence import DaySequence, instants_of, one_process
from vrut_lite.app.panels.file_title import file_title, scene_and_place
from vrut_lite.app.panels.size_chooser import SizeChooser
from vrut_lite.app.widgets import Chooser, aligned_form, faint_label, panel_column
from vrut_lite.errors import UserError
from vrut_lite.pictures.film import FILM_FORMATS
from vrut_lite.pictures.image_files import DISPLAY_FORMATS, picture_format
from vrut_lite.quantities import COMPUTING, W_M2_SR

_PICTURES = "Pictures (*.png *.jpg *.exr)"
_KINDS = {
    "PNG files": ".png",
    "JPEG files": ".jpg",
    "EXR files": ".exr",
    "film, MP4": ".mp4",
    "film, WebP": ".webp",
}


class ExportPanel(QWidget):
    """`open_workers` makes the process that draws the pictures of a day."""

    def __init__(
        self,
        session: Session,
        scout: SunDayFinder,
        open_workers: Callable[[], Executor] = one_process,
    ):
        super().__init__()
        self._session, self._scout = session, scout
        self._open_workers = open_workers
        self.sequence: DaySequence | None = None
        self._hours_typed = False
        self._make_parts()
        self._lay_out()
        self._show_running(False)
        self.picture.clicked.connect(self.ask_for_picture)
        self.day.clicked.connect(self._ask_for_day)
        self.cancel.clicked.connect(self.stop)
        self.light.clicked.connect(self._take_light_hours)
        self.kind.currentTextChanged.connect(lambda _: self._show_kind())
        for field in (self.first, self.last):
            field.refused.connect(session.problem)
            field.time_typed.connect(lambda _: self._keep_hours())
        self.step_minutes.valueChanged.connect(lambda _: self._show_count())
        scout.day_changed.connect(lambda _: self._show_day())
        session.ended.connect(self.stop)

    def export(self, path: str) -> None:
        """Write the picture that is shown, in the chosen size."""
        self._tell("Drawing the picture \N{HORIZONTAL ELLIPSIS}")
        export_picture(self._session, path, self._tell, self.chosen_size.size_px)

    def start(self, path: str) -> None:
        """Make the pictures of the chosen hours, or the film of them that the suffix names."""
        day = self._scout.day
        if day is None or (self.sequence is not None and self.sequence.running):
            return
        project, size = project_of(self._session), self.chosen_size.size_px
        if size is not None:
            project = msgspec.structs.replace(project, size=size)
        sequence = DaySequence(project, self._instants(day), Path(path), self, self._open_workers)
        sequence.progressed.connect(self._show_progress)
        sequence.finished.connect(self._ended)
        sequence.failed.connect(self._failed)
        try:
            picture_format(path, (*DISPLAY_FORMATS, *FILM_FORMATS))
            sequence.start(day.zone)
        except UserError as error:
            self._session.problem.emit(str(error))
            return
        self.sequence = sequence
        self._show_progress(0, len(sequence.paths))
        self._show_running(True)

    def stop(self) -> None:
        """Stop after the picture that is being made."""
        if self.sequence is not None:
            self.sequence.cancel()

    def ask_for_picture(self) -> None:
        """Let a name be chosen, and write the picture that is shown."""
        path = self._new_name("Export picture", f"{file_title(self._session)}.png", _PICTURES)
        if path:
            self.export(path if Path(path).suffix else f"{path}.png")

    def _make_parts(self) -> None:
        self.chosen_size = SizeChooser()
        self.picture = QPushButton("Export this picture\N{HORIZONTAL ELLIPSIS}")
        self.picture.setToolTip(f"PNG or JPEG as shown, EXR of linear radiance in {W_M2_SR}")
        self.first, self.last = ClockField(), ClockField()
        self.first.setAccessibleName("hour of the first picture")
        self.last.setAccessibleName("hour of the last picture")
        self.light = QToolButton()
        put_sign(self.light, "reset")
        self.light.setToolTip("From civil dawn to civil dusk")
        self.light.setAccessibleName("from dawn to dusk")
        self.step_minutes = QSpinBox()
        self.step_minutes.setAccessibleName("minutes from picture to picture")
        self.step_minutes.setRange(1, 120)
        self.step_minutes.setValue(20)
        self.step_minutes.setSuffix(" min")
        self.kind = Chooser()
        self.kind.setAccessibleName("kind of file of a day")
        self.kind.addItems(list(_KINDS))
        self.day = QPushButton()
        self._show_kind()
        self.day.setToolTip(
            "Files that carry their hour in the name, or a film; the window goes on"
        )
        self.count = faint_label(f"hours of light: {COMPUTING}")
        self.progress = QProgressBar()
        self.progress.setFormat("%v of %m")
        self.cancel = QPushButton("Cancel")
        self.status = faint_label(wraps=True)

    def _lay_out(self) -> None:
        hours = QHBoxLayout()
        hours.setSpacing(6)
        for part in (self.first, faint_label("to"), self.last, self.light):
            hours.addWidget(part)
        hours.addStretch(1)
        sizes, form = aligned_form(), aligned_form()
        sizes.addRow("Size", self.chosen_size)
        form.addRow("From", hours)
        form.addRow("A picture each", self.step_minutes)
        form.addRow("As", self.kind)
        form.addRow("", self.count)
        row = QHBoxLayout()
        row.addWidget(self.progress, 1)
        row.addWidget(self.cancel)
        column = panel_column(self)
        column.addLayout(sizes)
        column.addWidget(self.picture)
        column.addWidget(self.status)
        column.addLayout(row)
        column.addLayout(form)
        column.addWidget(self.day)
        column.addStretch(1)

    # --- hours -------------------------------------------------------------------------------

    def _instants(self, day: Day) -> list[datetime]:
        step = timedelta(minutes=self.step_minutes.value())
        return instants_of(day, step, _instant(day, self.first.time), _instant(day, self.last.time))

    def _keep_hours(self) -> None:
        """Hours that were typed hold for other days and places too."""
        self._hours_typed = True
        self._show_count()

    def _take_light_hours(self) -> None:
        self._hours_typed = False
        self._show_light_hours()

    def _show_day(self) -> None:
        if self._hours_typed:
            self._show_count()
        else:
            self._show_light_hours()

    def _show_light_hours(self) -> None:
        """From civil dawn to civil dusk, or the whole day where either is missing."""
        day = self._scout.day
        if day is None:
            return
        instants = instants_of(day, timedelta(minutes=1))
        for field, instant in ((self.first, instants[0]), (self.last, instants[-1])):
            local = instant.astimezone(day.zone)
            field.show_time(QTime(local.hour, local.minute))
        self._show_count()

    def _show_count(self) -> None:
        if self._scout.day is not None:
            self.count.setText(f"{len(self._instants(self._scout.day)):,} pictures")

    # --- files -------------------------------------------------------------------------------

    @property
    def _suffix(self) -> str:
        return _KINDS[self.kind.currentText()]

    def _show_kind(self) -> None:
        made = "Film" if self._suffix in FILM_FORMATS else "Pictures"
        self.day.setText(f"{made} of the day\N{HORIZONTAL ELLIPSIS}")

    def _ask_for_day(self) -> None:
        day, suffix = self._scout.day, self._suffix
        if day is None:
            return
        name = f"{scene_and_place(self._session)} {day.start.astimezone(day.zone):%Y-%m-%d}"
        path = self._new_name(
            self.day.text().rstrip("\N{HORIZONTAL ELLIPSIS}"), name + suffix, f"Files (*{suffix})"
        )
        if path:
            self.start(path if Path(path).suffix else path + suffix)

    def _new_name(self, title: str, name: str, kinds: str) -> str:
        proposed = str(Path(folder_of(self._session), name))
        return QFileDialog.getSaveFileName(self, title, proposed, kinds)[0]

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


def _instant(day: Day, time: QTime) -> datetime:
    """The instant at which the clock of the day's place shows a time."""
    local = day.start.astimezone(day.zone)
    return local.replace(hour=time.hour(), minute=time.minute(), second=time.second())

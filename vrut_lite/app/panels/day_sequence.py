"""Pictures of many hours of a day, or a film of them, made by another process."""

import shutil
import tempfile
from collections.abc import Callable
from concurrent.futures import Executor
from datetime import datetime, timedelta, tzinfo
from pathlib import Path

from PySide6.QtCore import QObject, Qt, Signal

from vrut_lite.app.engine.day import Day
from vrut_lite.pictures.film import FILM_FORMATS, film_format, film_of_files
from vrut_lite.project import Project
from vrut_lite.studio.pictures import Made, PicturePlan, make_one
from vrut_lite.studio.scene_pictures import ScenePlan
from vrut_lite.studio.workers import spawn_context
from vrut_lite.write_atomic import atomic_output, check_writable

PICTURES_A_SECOND = 12
_FRAME_SUFFIX = ".png"


def one_process() -> Executor:
    """A worker process; UserError if none can be started."""
    from concurrent.futures import ProcessPoolExecutor

    return ProcessPoolExecutor(1, mp_context=spawn_context())


class DaySequence(QObject):
    """Signals: `progressed` (pictures made, of how many), `finished` (a line), `failed` (a line).

    A `target` with a film's suffix becomes one film; otherwise each picture is a file of that
    suffix that carries its local time in its name. After `cancel` no further picture is begun:
    pictures that are finished stay, a film is given up.
    """

    progressed = Signal(int, int)
    finished = Signal(str)
    failed = Signal(str)
    _made = Signal(object)

    def __init__(
        self,
        project: Project,
        instants: list[datetime],
        target: Path,
        parent: QObject | None = None,
        open_workers: Callable[[], Executor] = one_process,
    ):
        super().__init__(parent)
        self._plan: PicturePlan = ScenePlan(project)
        self._instants, self._target = instants, target
        self._open_workers = open_workers
        self._workers: Executor | None = None
        self._done = 0
        self._frames = Path()
        self.paths: list[Path] = []
        self._made.connect(self._take, Qt.ConnectionType.QueuedConnection)

    @property
    def is_film(self) -> bool:
        """Whether one film is made."""
        return self._target.suffix.lower() in FILM_FORMATS

    @property
    def running(self) -> bool:
        """Whether pictures are being made."""
        return self._workers is not None

    def start(self, zone: tzinfo) -> None:
        """Begin; files are named by the clock of a zone.

        Raises:
            UserError: the files cannot be written there, or no process can be started.
        """
        if self.is_film:
            film_format(self._target)
            check_writable(self._target)
            self._frames = Path(tempfile.mkdtemp(prefix="vrut_lite_film_"))
            count = len(self._instants)
            self.paths = [self._frames / f"{n:05d}{_FRAME_SUFFIX}" for n in range(count)]
        else:
            self.paths = timed_paths(self._target, self._instants, zone)
            check_writable(self.paths[0])
        try:
            self._workers = self._open_workers()
        except BaseException:
            self._end()
            raise
        self._submit()

    def cancel(self) -> None:
        """Stop after the picture that is being made."""
        if self._workers is not None:
            self._end()
            self.finished.emit(f"stopped after {self._done} of {len(self._instants)} pictures")

    def _submit(self) -> None:
        assert self._workers is not None
        instant, suffix = self._instants[self._done], self.paths[self._done].suffix
        promise = self._workers.submit(make_one, self._plan, instant, suffix)
        promise.add_done_callback(lambda done: None if done.cancelled() else self._made.emit(done))

    def _take(self, promise: object) -> None:
        if self._workers is None:
            return
        try:
            made: Made | None = promise.result()  # type: ignore[attr-defined]
            if made is not None:
                self._write(made)
        except Exception as error:
            self._end()
            self.failed.emit(f"no further pictures of the day: {error}")
            return
        if made is None:
            self._end()
            self.finished.emit(f"{self._target}: {self._done} pictures")
            return
        self._done += 1
        self.progressed.emit(self._done, len(self._instants))
        # A listener may have cancelled.
        if not self.running:
            return
        if self._done < len(self._instants):
            self._submit()
        elif self.is_film:
            self._submit_film()
        else:
            self._end()
            self.finished.emit(f"{self._done} pictures, {self.paths[0]} to {self.paths[-1].name}")

    def _submit_film(self) -> None:
        """The worker answers None."""
        assert self._workers is not None
        promise = self._workers.submit(film_of_files, self._target, self.paths, PICTURES_A_SECOND)
        promise.add_done_callback(lambda done: None if done.cancelled() else self._made.emit(done))

    def _write(self, made: Made) -> None:
        path = self.paths[self._done]
        for suffix, content in made.files.items():
            with atomic_output(path.with_name(path.stem + suffix)) as beside:
                beside.write_bytes(content)

    def _end(self) -> None:
        if self._workers is not None:
            self._workers.shutdown(wait=False, cancel_futures=True)
            self._workers = None
        if self.is_film:
            shutil.rmtree(self._frames, ignore_errors=True)


def timed_paths(target: Path, instants: list[datetime], zone: tzinfo) -> list[Path]:
    """A file for each instant, named by its local hour and minute; each name once."""
    paths: list[Path] = []
    for instant in instants:
        local = instant.astimezone(zone)
        path = target.with_name(f"{target.stem} {local:%H.%M}{target.suffix}")
        if path in paths:
            # An hour that clocks have twice.
            path = target.with_name(f"{target.stem} {local:%H.%M %Z}{target.suffix}")
        paths.append(path)
    return paths


def instants_of(
    day: Day, step: timedelta, first: datetime | None = None, last: datetime | None = None
) -> list[datetime]:
    """Steps from a first to a last hour.

    Without them from civil dawn to civil dusk, or through the whole day if either is missing.
    """
    start = first or day.marks.get("civil dawn", day.start)
    end = last or day.marks.get("civil dusk", day.end)
    if end <= start:
        start, end = day.start, day.end
    return [start + i * step for i in range((end - start) // step + 1)]

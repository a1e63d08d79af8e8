"""Pictures of a whole day, made by another process."""

from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor
from datetime import datetime, timedelta
from pathlib import Path

from PySide6.QtCore import QObject, Qt, Signal

from vrut_lite.app.engine.day import Day
from vrut_lite.commands.pictures import Made, Plan, make_one
from vrut_lite.commands.scene_pictures import ScenePlan
from vrut_lite.commands.workers import spawn_context
from vrut_lite.project import Project
from vrut_lite.write_atomic import atomic_output, check_writable


def one_process() -> Executor:
    """A worker process; UserError if none can be started."""
    return ProcessPoolExecutor(1, mp_context=spawn_context())


class DaySequence(QObject):
    """Signals: `progressed` (pictures made, of how many), `finished` (a line), `failed` (a line).

    After `cancel` no further picture is begun; those that are finished stay.
    """

    progressed = Signal(int, int)
    finished = Signal(str)
    failed = Signal(str)
    _made = Signal(object)

    def __init__(
        self,
        project: Project,
        instants: list[datetime],
        pattern: Path,
        parent: QObject | None = None,
        open_workers: Callable[[], Executor] = one_process,
    ):
        super().__init__(parent)
        self._plan: Plan = ScenePlan(project)
        self._instants = instants
        self._pattern = pattern
        self._open_workers = open_workers
        self._workers: Executor | None = None
        self._done = 0
        self._made.connect(self._take, Qt.ConnectionType.QueuedConnection)

    def path(self, number: int) -> Path:
        """The file of a picture, counted from 1."""
        return self._pattern.with_name(f"{self._pattern.stem}_{number:04d}{self._pattern.suffix}")

    @property
    def running(self) -> bool:
        """Whether pictures are being made."""
        return self._workers is not None

    def start(self) -> None:
        """Begin.

        Raises:
            UserError: the files cannot be written there, or no process can be started.
        """
        check_writable(self.path(1))
        self._workers = self._open_workers()
        self._submit()

    def cancel(self) -> None:
        """Stop after the picture that is being made."""
        if self._workers is not None:
            self._end()
            self.finished.emit(f"stopped after {self._done} of {len(self._instants)} pictures")

    def _submit(self) -> None:
        assert self._workers is not None
        instant = self._instants[self._done]
        promise = self._workers.submit(make_one, self._plan, instant, self._pattern.suffix)
        promise.add_done_callback(lambda done: None if done.cancelled() else self._made.emit(done))

    def _take(self, promise: object) -> None:
        if self._workers is None:
            return
        try:
            made: Made = promise.result()  # type: ignore[attr-defined]
            self._write(made)
        except Exception as error:
            self._end()
            self.failed.emit(f"no further pictures of the day: {error}")
            return
        self._done += 1
        self.progressed.emit(self._done, len(self._instants))
        # A listener may have cancelled.
        if not self.running:
            return
        if self._done < len(self._instants):
            self._submit()
            return
        self._end()
        self.finished.emit(f"{self._done} pictures, {self.path(1)} to {self.path(self._done).name}")

    def _write(self, made: Made) -> None:
        path = self.path(self._done + 1)
        for suffix, content in made.files.items():
            with atomic_output(path.with_suffix(suffix)) as beside:
                beside.write_bytes(content)

    def _end(self) -> None:
        if self._workers is not None:
            self._workers.shutdown(wait=False, cancel_futures=True)
            self._workers = None


def instants_of(day: Day, step: timedelta) -> list[datetime]:
    """Steps from civil dawn to civil dusk, or through the whole day if either is missing."""
    start = day.marks.get("civil dawn", day.start)
    end = day.marks.get("civil dusk", day.end)
    if end <= start:
        start, end = day.start, day.end
    return [start + i * step for i in range((end - start) // step + 1)]

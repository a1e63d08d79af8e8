"""A window as `vrut-lite run` opens it, worked by a script and measured between two acts."""

import gc
import time
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any, TypeVar

from PySide6.QtCore import QEventLoop, QPoint, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import GlStage, Stage
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.theme import apply_theme
from vrut_lite.app.window.kept import Kept
from vrut_lite.app.window.main_window import MainWindow
from vrut_lite.kernel.messages import Input, SetClock
from vrut_lite.project import Project
from vrut_lite_lab.memory_tour.gl_memory import GlMemory, gl_memory

T = TypeVar("T")
_POLL_MS = 10
# A picture is the last one of an act when none has followed for so long.
_REST_S, _LIMIT_S = 0.4, 180.0


class MeasuredStage(GlStage):
    """Counts the objects of its context."""

    def gl_memory(self) -> GlMemory:
        """What the context holds."""
        return self.host.gl.call(lambda _: gl_memory())


class TouredWindow:
    """The window, and ways to wait for it."""

    def __init__(self, app: QApplication, folder: Path, size: tuple[int, int]):
        self.app, self.folder = app, folder
        apply_theme(app)
        self.session = Session(MeasuredStage)
        self.session.start()
        self.window = MainWindow(self.session, PresetStore(folder / "presets"), Kept(folder))
        self.session.ready.connect(lambda catalogue: gc.freeze())
        self.shown: Shown | None = None
        self._shown_s = 0.0
        self.pictures = 0
        self.problems: list[str] = []
        self.session.problem.connect(self.problems.append)
        self.session.picture_shown.connect(self._note)
        self.window.resize(*size)
        self.window.show()
        self.until(lambda: bool(self.session.catalogue.modules))

    def _note(self, shown: Shown) -> None:
        self.shown, self._shown_s = shown, time.monotonic()
        self.pictures += 1

    def until(self, is_so: Callable[[], object], limit_s: float = _LIMIT_S) -> bool:
        """Let events happen until something is so; False after the limit."""
        loop, end_s = QEventLoop(), time.monotonic() + limit_s
        timer = QTimer(interval=_POLL_MS)
        timer.timeout.connect(lambda: loop.quit() if is_so() or time.monotonic() > end_s else None)
        timer.start()
        loop.exec()
        return time.monotonic() <= end_s

    def wait(self, seconds: float) -> None:
        """Let events happen for a while."""
        end_s = time.monotonic() + seconds
        self.until(lambda: time.monotonic() >= end_s, seconds + 1.0)

    def settle(self) -> None:
        """Wait for a finished picture after which none comes for a while."""
        begin_s = time.monotonic()

        def rests() -> bool:
            shown, now_s = self.shown, time.monotonic()
            return (
                shown is not None
                and shown.still
                and self._shown_s >= begin_s
                and now_s > self._shown_s + _REST_S
                and not self.session.waits_for
            )

        # An act that changes no picture, as one that opens a panel, ends without one.
        if not self.until(lambda: self._shown_s >= begin_s, 3.0):
            return
        self.until(rests, 60.0)

    def send(self, *inputs: Input) -> None:
        """Send inputs, and wait for their picture."""
        self.session.send(*inputs)
        self.settle()

    def hour(self, instant: datetime) -> None:
        """Go to an instant, and wait for its picture."""
        self.send(SetClock(instant=instant))

    def open(self, project: Project) -> None:
        """Open a project, and wait for its picture."""
        self.window.files.open_project(project)
        self.settle()

    def asked(self, question: Callable[[Stage], T]) -> T:
        """The engine's answer.

        Raises:
            RuntimeError: there is none.
        """
        answers: list[T] = []
        refusals: list[str] = []
        self.session.ask(question, answers.append, refusals.append)
        if not self.until(lambda: answers or refusals) or refusals:
            raise RuntimeError("; ".join(refusals) or "the window does not answer")
        return answers[0]

    def gl_memory(self) -> GlMemory:
        """What the context holds."""

        def of_stage(stage: Stage) -> GlMemory:
            assert isinstance(stage, MeasuredStage)
            return stage.gl_memory()

        return self.asked(of_stage)

    def trigger(self, action: str) -> None:
        """An entry of a menu."""
        self.window.actions_by_name[action].trigger()

    def click(self, widget: QWidget, x: float, y: float) -> None:
        """A click at shares of a widget's size."""
        spot = QPoint(round(x * widget.width()), round(y * widget.height()))
        QTest.mouseClick(widget, Qt.MouseButton.LeftButton, pos=spot)

    def drag(self, widget: QWidget, *shares: tuple[float, float]) -> None:
        """A drag through points at shares of a widget's size, as a hand makes it."""
        spots = [QPoint(round(x * widget.width()), round(y * widget.height())) for x, y in shares]
        QTest.mousePress(widget, Qt.MouseButton.LeftButton, pos=spots[0])
        for spot in spots[1:]:
            QTest.mouseMove(widget, spot)
            self.wait(0.05)
        QTest.mouseRelease(widget, Qt.MouseButton.LeftButton, pos=spots[-1])

    def panel(self, name: str) -> Any:
        """A panel, of whatever class."""
        return self.window.panels[name]

    def close(self) -> None:
        """Close the window and end its threads."""
        self.window.close()
        self.until(lambda: self.session.has_ended)
        self.session.join()

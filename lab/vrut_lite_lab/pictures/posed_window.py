"""A window of the application that can be waited for and looked at, part by part."""

import time
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRect
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication, QWidget

from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.window.main_window import MainWindow
from vrut_lite.kernel.messages import ClockMoved, SetClock
from vrut_lite.project import Project

# Of the window alone.
SIZE = (1280, 800)
_REST_S, _LIMIT_S = 1.5, 3600.0

Pixels = NDArray[np.uint8]


class PosedWindow:
    """A window that can be waited for and looked at, part by part."""

    def __init__(self, app: QApplication, folder: Path, first: Project, place: QRect | None = None):
        self._app = app
        self.session = Session()
        self.window = MainWindow(self.session, PresetStore(folder))
        self._shown: Shown | None = None
        self._shown_s = 0.0
        self.session.picture_shown.connect(self._note)
        if place is None:
            self.window.resize(*SIZE)
        else:
            self.window.setGeometry(place)
        # How long a frame took says more of what else runs than of the window.
        self.window.statusBar().facts.hide()  # type: ignore[attr-defined]
        self.window.show()
        self.session.start()
        self.open(first)
        self.until(lambda: "module clouds" in self.window.docks)

    def _note(self, shown: Shown) -> None:
        self._shown, self._shown_s = shown, time.monotonic()

    def open(self, project: Project) -> None:
        """Become a project's picture."""
        self.window.files.open_project(project)
        self.finish(anew=True)

    def move_to(self, instant: datetime) -> None:
        """Become the picture of another hour; of the same one none is drawn anew."""
        clock = self.session.last(ClockMoved)
        if clock is not None and clock.instant == instant:
            return
        self.session.send(SetClock(instant=instant))
        self.finish(anew=True)

    def finish(self, anew: bool = False) -> None:
        """Wait for a finished picture of the window's size, after which none comes for a while;
        `anew` for one that is still to come."""
        if anew:
            self._shown = None
        self.rest()
        self.until(
            lambda: (
                self._shown is not None
                and self._shown.still
                and self._shown.picture.display.shape[1::-1] == self.window.desk.viewport.pixels
                and time.monotonic() > self._shown_s + 2.0 * _REST_S
            )
        )

    def until(self, is_so: Callable[[], bool]) -> None:
        """Let events happen until something is so."""
        end = time.monotonic() + _LIMIT_S
        while not is_so():
            if time.monotonic() > end:
                raise TimeoutError("the window did not come to rest")
            self._app.processEvents()
            time.sleep(0.01)

    def rest(self) -> None:
        """Let events happen for a while."""
        end = time.monotonic() + _REST_S
        self.until(lambda: time.monotonic() > end)

    def panel(self, name: str) -> Pixels:
        """All of a panel, at the width of a dock."""
        self.window.show_dock(name)
        self.rest()
        return seen(self.window.panels[name])


def seen(widget: QWidget) -> Pixels:
    """What a widget looks like (height, width, 3)."""
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), -1)
    return rows[:, : 3 * image.width()].reshape(image.height(), -1, 3).copy()

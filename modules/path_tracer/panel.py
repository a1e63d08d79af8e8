"""The panel of the path-traced picture: the picture is traced while the panel is seen.

The window imports it by the entry point `vrut_lite.panels`; nothing else here imports Qt.
"""

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from path_tracer.messages import PathTracedPicture
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.fitted_picture import FittedPicture
from vrut_lite.daylight.picture import SetExposure
from vrut_lite.kernel.messages import Demand
from vrut_lite.pictures.display import display_picture
from vrut_lite.pictures.white_balance import white_balance_matrix

_CONSUMER = "window"
_WAITING = "Paths of light are traced while this is seen, without air and clouds."


class Developed(NamedTuple):
    """A picture (h, w, 3) as the screen shows it, and how many of its samples are there."""

    pixels: NDArray[np.uint8]
    samples: int
    samples_wanted: int


class TracedPanel(QWidget):
    """Asks for pictures while it is visible; they have the frame's exposure and tone map."""

    title = "Path-traced picture"
    keys = "T"

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self.shown: Developed | None = None
        self.view = FittedPicture("path-traced picture", (360, 240))
        self.progress = QLabel(_WAITING)
        self.progress.setWordWrap(True)
        column = QVBoxLayout(self)
        column.setContentsMargins(10, 8, 8, 10)
        column.addWidget(self.view, 1)
        column.addWidget(self.progress)
        session.listen(PathTracedPicture, self._hear)

    def showEvent(self, event: QShowEvent) -> None:
        """Ask for the picture."""
        self._demand(None)

    def hideEvent(self, event: QHideEvent) -> None:
        """Take the demand back."""
        if not self._session.has_ended:
            self._demand(0)

    def _demand(self, size: int | None) -> None:
        self._session.send(
            Demand(consumer=_CONSUMER, message=PathTracedPicture.__name__, size=size)
        )

    def _hear(self, message: PathTracedPicture) -> None:
        if self.isVisible():
            frame = self._session.shown
            ev100 = None if frame is None else frame.picture.ev100
            # Off Qt's thread: a tone map takes a tenth of a second.
            self._session.ask(partial(_developed, message, ev100), self._show)

    def _show(self, developed: Developed) -> None:
        self.shown = developed
        self.view.show_pixels(developed.pixels)
        self.progress.setText(f"{developed.samples} of {developed.samples_wanted} paths a pixel")


def _developed(message: PathTracedPicture, ev100: float | None, stage: Stage) -> Developed:
    wish = stage.kernel.last(SetExposure) or SetExposure()
    balance = white_balance_matrix(wish.white_temperature_k, wish.white_duv)
    pixels = display_picture(message.radiance.values, ev100, wish.tone_map, balance)
    return Developed(pixels.astype(np.uint8), message.samples, message.samples_wanted)

"""The picture that a path tracer makes, beside the frame: it grows while it is seen."""

from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRect, QSize, Qt
from PySide6.QtGui import QColor, QHideEvent, QImage, QPainter, QPaintEvent, QShowEvent
from PySide6.QtWidgets import QLabel, QSizePolicy, QVBoxLayout, QWidget

from vrut_lite.app import theme
from vrut_lite.app.session import Session
from vrut_lite.app.stage import Stage
from vrut_lite.daylight.picture import SetExposure
from vrut_lite.kernel.messages import Demand, Message
from vrut_lite.pictures.display import display_picture
from vrut_lite.pictures.white_balance import white_balance_matrix

# Whichever module says a message of this name, with these fields: radiance (h, w, 3), samples,
# samples_wanted.
PICTURE = "PathTracedPicture"
_CONSUMER = "window"
_WAITING = "Paths of light are traced while this is seen, without air and clouds."


class Developed(NamedTuple):
    """A picture (h, w, 3) as the screen shows it, and how many of its samples are there."""

    pixels: NDArray[np.uint8]
    samples: int
    samples_wanted: int


class TracedPanel(QWidget):
    """Asks for pictures while it is visible; they have the frame's exposure and tone map."""

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self.shown: Developed | None = None
        self.view = _View()
        self.told = QLabel(_WAITING)
        self.told.setWordWrap(True)
        column = QVBoxLayout(self)
        column.setContentsMargins(10, 8, 8, 10)
        column.addWidget(self.view, 1)
        column.addWidget(self.told)
        session.heard.connect(self._hear)

    def showEvent(self, event: QShowEvent) -> None:
        """Ask for the picture."""
        self._demand(1)

    def hideEvent(self, event: QHideEvent) -> None:
        """Nobody looks: nothing is to be traced."""
        if not self._session.has_ended:
            self._demand(0)

    def _demand(self, size: int) -> None:
        self._session.send(Demand(consumer=_CONSUMER, message=PICTURE, size=size))

    def _hear(self, message: Message, _sender: str) -> None:
        if type(message).__name__ == PICTURE and self.isVisible():
            frame = self._session.shown
            ev100 = None if frame is None else frame.picture.ev100
            # Off Qt's thread: a tone map takes a tenth of a second.
            self._session.ask(partial(_developed, message, ev100), self._show)

    def _show(self, developed: Developed) -> None:
        self.shown = developed
        self.view.show_pixels(developed.pixels)
        self.told.setText(f"{developed.samples} of {developed.samples_wanted} paths a pixel")


def _developed(message: Any, ev100: float | None, stage: Stage) -> Developed:
    wish = stage.kernel.last(SetExposure) or SetExposure()
    balance = white_balance_matrix(wish.white_temperature_k, wish.white_duv)
    pixels = display_picture(message.radiance.values, ev100, wish.tone_map, balance)
    return Developed(pixels.astype(np.uint8), message.samples, message.samples_wanted)


class _View(QWidget):
    """A picture, as large as there is room."""

    def __init__(self) -> None:
        super().__init__()
        self._image: QImage | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAccessibleName("path-traced picture")

    def sizeHint(self) -> QSize:
        """Half of a window's picture."""
        return QSize(360, 240)

    def show_pixels(self, pixels: NDArray[np.uint8]) -> None:
        """Show sRGB (h, w, 3)."""
        height, width = pixels.shape[:2]
        data = np.ascontiguousarray(pixels)
        image = QImage(data.data, width, height, 3 * width, QImage.Format.Format_RGB888)
        self._image = image.copy()
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """The picture, unstretched."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(theme.BACKGROUND))
        if self._image is not None:
            size = self._image.size().scaled(self.size(), Qt.AspectRatioMode.KeepAspectRatio)
            place = QRect(0, 0, size.width(), size.height())
            place.moveCenter(self.rect().center())
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            painter.drawImage(place, self._image)

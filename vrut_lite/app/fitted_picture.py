"""A widget that shows a picture as large as its room allows, unstretched."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRect, QSize, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from vrut_lite.app import theme
from vrut_lite.app.widgets import rgb_image


class FittedPicture(QWidget):
    """A picture on the theme's background.

    Args:
        name: told by screen readers.
        hint_px: preferred width and height.
        smooth: pixels are interpolated; otherwise they keep sharp edges.
    """

    def __init__(self, name: str, hint_px: tuple[int, int], smooth: bool = True):
        super().__init__()
        self._image: QImage | None = None
        self._hint_px, self._smooth = hint_px, smooth
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAccessibleName(name)

    def sizeHint(self) -> QSize:
        """The preferred size."""
        return QSize(*self._hint_px)

    def minimumSizeHint(self) -> QSize:
        """Half of the hinted size, large enough to recognise the picture."""
        return self.sizeHint() / 2

    def show_pixels(self, pixels: NDArray[np.uint8] | None) -> None:
        """Show sRGB (h, w, 3), or nothing."""
        self._image = None if pixels is None else rgb_image(pixels)
        self.update()

    @property
    def picture_place(self) -> QRect:
        """Where the picture lies in the widget; empty without one."""
        if self._image is None:
            return QRect()
        size = self._image.size().scaled(self.size(), Qt.AspectRatioMode.KeepAspectRatio)
        place = QRect(0, 0, size.width(), size.height())
        place.moveCenter(self.rect().center())
        return place

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the picture in the middle."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(theme.BACKGROUND))
        if self._image is not None:
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, self._smooth)
            painter.drawImage(self.picture_place, self._image)

"""The whole sky as a clickable fisheye."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPainterPath, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from vrut_lite.app import theme
from vrut_lite.app.widgets import rgb_image
from vrut_lite.geometry.frames import (
    angles_from_direction,
    direction_from_angles,
    enu_from_world,
    world_from_enu,
)
from vrut_lite.numeric_types import Vector

_MARK_PX = 6.0


class SkyDisc(QWidget):
    """Looking up, north at the top, east on the left; `pointed` emits a world direction."""

    pointed = Signal(object)

    def __init__(self, name: str) -> None:
        super().__init__()
        self._image: QImage | None = None
        self._north_offset_rad = 0.0
        self._sun: Vector | None = None
        self._direction: Vector | None = None
        self.setCursor(Qt.CursorShape.CrossCursor)
        policy = QSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        policy.setHeightForWidth(True)
        self.setSizePolicy(policy)
        self.setAccessibleName(name)
        self.setToolTip("The whole sky, north at the top: click for the spectrum of a direction")

    def sizeHint(self) -> QSize:
        """A square."""
        return QSize(180, 180)

    def heightForWidth(self, width: int) -> int:
        """A square."""
        return width

    def show_sky(self, pixels: NDArray[np.uint8], sun: Vector, north_offset_rad: float) -> None:
        """Show a fisheye (n, n, 3) and the sun's place."""
        self._image = rgb_image(pixels)
        self._sun, self._north_offset_rad = sun, north_offset_rad
        self.update()

    def show_direction(self, direction: Vector) -> None:
        """Mark a direction."""
        self._direction = direction
        self.update()

    def position_of(self, direction: Vector) -> QPointF | None:
        """The point of a world direction on the widget; None below the horizon."""
        azimuth, elevation = angles_from_direction(
            enu_from_world(direction, self._north_offset_rad)
        )
        if elevation < 0.0:
            return None
        place = self._place()
        radius_px = 0.5 * place.width() * (1.0 - float(elevation) / (0.5 * np.pi))
        return place.center() - QPointF(
            radius_px * float(np.sin(azimuth)), radius_px * float(np.cos(azimuth))
        )

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Emit the direction that was clicked."""
        place = self._place()
        way = (event.position() - place.center()) / (0.5 * place.width())
        radius = float(np.hypot(way.x(), way.y()))
        if radius >= 1.0:
            return
        enu = direction_from_angles(np.arctan2(-way.x(), -way.y()), 0.5 * np.pi * (1.0 - radius))
        x, y, z = world_from_enu(enu, self._north_offset_rad).tolist()
        self.pointed.emit((x, y, z))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Emit the direction while dragging."""
        self.mousePressEvent(event)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the sky, a ring around the sun, a cross at the direction."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        place = self._place()
        if self._image is None:
            painter.setPen(QPen(QColor(theme.LINE), 1))
            painter.drawEllipse(place)
            return
        circle = QPainterPath()
        circle.addEllipse(place)
        painter.setClipPath(circle)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.drawImage(place, self._image)
        painter.setClipping(False)
        painter.setPen(QPen(QColor(theme.LINE), 1))
        painter.drawEllipse(place)
        self._paint_marks(painter)

    def _paint_marks(self, painter: QPainter) -> None:
        sun = None if self._sun is None else self.position_of(self._sun)
        cross = None if self._direction is None else self.position_of(self._direction)
        painter.setPen(QPen(QColor(theme.ACCENT), 1.5))
        if sun is not None:
            painter.drawEllipse(sun, _MARK_PX, _MARK_PX)
        painter.setPen(QPen(QColor("#ffffff"), 1.2))
        if cross is not None:
            painter.drawLine(cross - QPointF(_MARK_PX, 0), cross + QPointF(_MARK_PX, 0))
            painter.drawLine(cross - QPointF(0, _MARK_PX), cross + QPointF(0, _MARK_PX))

    def _place(self) -> QRectF:
        side = min(self.width(), self.height()) - 2.0
        return QRectF((self.width() - side) / 2, (self.height() - side) / 2, side, side)

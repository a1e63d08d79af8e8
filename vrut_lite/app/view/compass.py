"""The compass over the picture: its points along the horizon, and a rose in the corner."""

import math

import numpy as np
from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from vrut_lite.app.view.view_projection import project_directions
from vrut_lite.geometry.frames import direction_from_angles, enu_from_world, world_from_enu
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.place import SetPlace

_POINTS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")
_STEP_DEG = 15
_COLOUR, _SHADOW, _NORTH = QColor("#f4f4f0"), QColor(0, 0, 0, 150), QColor("#e58a78")
_ROSE_PX, _EDGE_PX = 22.0, 40.0


class Compass(QObject):
    """North is the place's own, so it turns with the scene's north offset."""

    changed = Signal()

    def __init__(self, parent: QObject | None = None):
        super().__init__(parent)
        self.shown = False
        self._north_offset_rad = 0.0

    def show(self, shown: bool) -> None:
        """Draw it, or not."""
        self.shown = shown
        self.changed.emit()

    def set_place(self, place: SetPlace) -> None:
        """Take over where the scene's north is."""
        self._north_offset_rad = place.north_offset_rad
        self.changed.emit()

    def paint(self, painter: QPainter, place: QRectF, camera: MoveCamera) -> None:
        """Draw over a picture of this camera that fills `place`."""
        if not self.shown:
            return
        azimuths_deg = np.arange(0, 360, _STEP_DEG)
        enu = direction_from_angles(np.radians(azimuths_deg), np.zeros(azimuths_deg.size))
        level = world_from_enu(enu, self._north_offset_rad)
        points = project_directions(level, camera, place.width() / place.height())
        for azimuth_deg, (x, y) in zip(azimuths_deg.tolist(), points.tolist(), strict=True):
            if 0.0 <= x <= 1.0 and 0.0 <= y <= 1.0:
                spot = QPointF(place.left() + x * place.width(), place.top() + y * place.height())
                _paint_point(painter, spot, azimuth_deg)
        middle = QPointF(place.right() - _EDGE_PX, place.top() + _EDGE_PX)
        _paint_rose(painter, middle, self.azimuth_rad(camera))

    def azimuth_rad(self, camera: MoveCamera) -> float:
        """Azimuth of the camera's view, clockwise from true north."""
        way = np.subtract(camera.target_m, camera.eye_m)
        east, north, _ = enu_from_world(way, self._north_offset_rad)
        return math.atan2(float(east), float(north))


def _paint_point(painter: QPainter, spot: QPointF, azimuth_deg: int) -> None:
    is_named = azimuth_deg % 45 == 0
    length = 8.0 if is_named else 4.0
    for colour, width in ((_SHADOW, 3.0), (_COLOUR, 1.2)):
        painter.setPen(QPen(colour, width))
        painter.drawLine(spot - QPointF(0.0, length), spot + QPointF(0.0, length))
    if is_named:
        text = QRectF(spot.x() - 20.0, spot.y() - 26.0, 40.0, 16.0)
        _write(painter, text, _POINTS[azimuth_deg // 45])


def _paint_rose(painter: QPainter, middle: QPointF, azimuth_rad: float) -> None:
    """A needle to the north, as seen from above with the view upwards."""
    painter.setPen(QPen(_COLOUR, 1.2))
    painter.setBrush(QColor(16, 16, 18, 120))
    painter.drawEllipse(middle, _ROSE_PX, _ROSE_PX)
    north = QPointF(-math.sin(azimuth_rad), -math.cos(azimuth_rad))
    side = QPointF(-north.y(), north.x())
    painter.setPen(Qt.PenStyle.NoPen)
    for way, colour in ((1.0, _NORTH), (-1.0, _COLOUR)):
        tip = middle + north * (way * (_ROSE_PX - 5.0))
        painter.setBrush(colour)
        painter.drawPolygon(QPolygonF([tip, middle + side * 4.0, middle - side * 4.0]))
    letter = middle + north * (_ROSE_PX + 8.0)
    _write(painter, QRectF(letter.x() - 10.0, letter.y() - 8.0, 20.0, 16.0), "N")


def _write(painter: QPainter, place: QRectF, text: str) -> None:
    for shift, colour in ((1.0, _SHADOW), (0.0, _COLOUR)):
        painter.setPen(colour)
        painter.drawText(place.translated(shift, shift), Qt.AlignmentFlag.AlignCenter, text)

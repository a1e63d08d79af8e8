"""A small clickable world map: land, the place, day and night."""

from functools import lru_cache

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPen,
    QPixmap,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from vrut_lite.app import theme
from vrut_lite.geometry.world_outline import world_outline

_SEA, _LAND, _COAST = "#17191d", "#3a3d3f", "#505456"
_NIGHT_ALPHA = 120
# The shade is smooth, so that few pixels are enough.
_SHADE_SIZE = (180, 90)


# North and east.
_WAYS = {
    Qt.Key.Key_Up: (1.0, 0.0), Qt.Key.Key_Down: (-1.0, 0.0),
    Qt.Key.Key_Left: (0.0, -1.0), Qt.Key.Key_Right: (0.0, 1.0),
}  # fmt: skip


class WorldMap(QWidget):
    """An equirectangular map; `place_chosen` emits latitude and longitude in degrees."""

    place_chosen = Signal(float, float)

    def __init__(self) -> None:
        super().__init__()
        self._place: tuple[float, float] | None = None
        self._land: QPixmap | None = None
        self._shade: QImage | None = None
        self.setCursor(Qt.CursorShape.CrossCursor)
        policy = QSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        policy.setHeightForWidth(True)
        self.setSizePolicy(policy)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setToolTip("Click a place, or go there by arrows; Shift for farther")
        self.setAccessibleName("world map")

    def sizeHint(self) -> QSize:
        """Twice as wide as high."""
        return QSize(320, 160)

    def heightForWidth(self, width: int) -> int:
        """Twice as wide as high."""
        return width // 2

    def show_place(self, latitude_deg: float, longitude_deg: float) -> None:
        """Mark a place."""
        self._place = (latitude_deg, longitude_deg)
        self.update()

    def show_sun(self, latitude_deg: float, longitude_deg: float) -> None:
        """Shade the night side for a sun in the zenith of this point."""
        self._shade = _night_shade(latitude_deg, longitude_deg)
        self.update()

    def position_of(self, latitude_deg: float, longitude_deg: float) -> QPointF:
        """The point of a place on the widget."""
        return QPointF(
            (longitude_deg + 180.0) / 360.0 * self.width(),
            (90.0 - latitude_deg) / 180.0 * self.height(),
        )

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Choose the clicked place, to a tenth of a degree."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        longitude_deg = event.position().x() / self.width() * 360.0 - 180.0
        latitude_deg = 90.0 - event.position().y() / self.height() * 180.0
        self.place_chosen.emit(
            round(min(max(latitude_deg, -90.0), 90.0), 1),
            round(min(max(longitude_deg, -180.0), 180.0), 1),
        )

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Arrows go a degree, with Shift ten."""
        key = Qt.Key(event.key())
        if self._place is None or key not in _WAYS:
            super().keyPressEvent(event)
            return
        far = event.modifiers() & Qt.KeyboardModifier.ShiftModifier
        north, east = (way * (10.0 if far else 1.0) for way in _WAYS[key])
        latitude_deg = min(max(self._place[0] + north, -90.0), 90.0)
        longitude_deg = (self._place[1] + east + 180.0) % 360.0 - 180.0
        # The next key counts from here without waiting for the kernel.
        self.show_place(latitude_deg, longitude_deg)
        self.place_chosen.emit(latitude_deg, longitude_deg)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Land, night, place."""
        ratio = self.devicePixelRatioF()
        if self._land is None or self._land.size() != self.size() * ratio:
            self._land = self._paint_land(ratio)
        painter = QPainter(self)
        painter.drawPixmap(0, 0, self._land)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        if self._shade is not None:
            painter.drawImage(QRectF(self.rect()), self._shade)
        if self._place is not None:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(QPen(QColor(theme.BACKGROUND), 1))
            painter.setBrush(QColor(theme.ACCENT))
            painter.drawEllipse(self.position_of(*self._place), 4, 4)
        if self.hasFocus():
            painter.setPen(QPen(QColor(theme.ACCENT), 1))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))

    def _paint_land(self, ratio: float) -> QPixmap:
        pixmap = QPixmap(self.size() * ratio)
        pixmap.setDevicePixelRatio(ratio)
        pixmap.fill(QColor(_SEA))
        painter = QPainter(pixmap)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.scale(self.width() / 360.0, self.height() / 180.0)
        painter.setPen(QPen(QColor(_COAST), 0))
        painter.setBrush(QColor(_LAND))
        painter.drawPath(_land_path())
        painter.end()
        return pixmap


@lru_cache(maxsize=1)
def _land_path() -> QPainterPath:
    """Land in degrees east of 180 W and south of 90 N."""
    path = QPainterPath()
    for ring in world_outline():
        points = [QPointF(180.0 + float(lon), 90.0 - float(lat)) for lon, lat in ring]
        path.moveTo(points[0])
        for point in points[1:]:
            path.lineTo(point)
        path.closeSubpath()
    return path


def _night_shade(latitude_deg: float, longitude_deg: float) -> QImage:
    """Black with the opacity of the night; opaque from 12 degrees below the horizon."""
    width, height = _SHADE_SIZE
    longitude = np.radians((np.arange(width) + 0.5) / width * 360.0 - 180.0 - longitude_deg)
    latitude = np.radians(90.0 - (np.arange(height) + 0.5) / height * 180.0)[:, None]
    declination = np.radians(latitude_deg)
    sine = np.sin(latitude) * np.sin(declination) + np.cos(latitude) * np.cos(declination) * np.cos(
        longitude
    )
    night = np.clip(-np.degrees(np.arcsin(np.clip(sine, -1.0, 1.0))) / 12.0, 0.0, 1.0)
    pixels = np.zeros((height, width, 4), np.uint8)
    pixels[..., 3] = np.rint(night * _NIGHT_ALPHA)
    image = QImage(pixels.data, width, height, 4 * width, QImage.Format.Format_RGBA8888)
    return image.copy()

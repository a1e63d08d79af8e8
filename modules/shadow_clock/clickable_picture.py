"""A picture in which the foot and the tip of a shadow are clicked."""

from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen

from shadow_clock.photo_facts import PhotoFacts
from vrut_lite.panel_kit import FittedPicture

_FOOT, _TIP = 0, 1
_MARK_PX, _MARK = 5, "#ffd678"
_HINT_PX = (280, 200)


class ClickablePicture(FittedPicture):
    """A picture with at most two clicked points (x, y), foot and tip, in the file's pixels.

    `changed` follows each click.
    """

    changed = Signal()

    def __init__(self) -> None:
        super().__init__("aerial picture with the shadow", _HINT_PX)
        self.points: list[tuple[float, float]] = []
        self._width_px = 1
        self.setCursor(Qt.CursorShape.CrossCursor)

    def show_photo(self, photo: PhotoFacts) -> None:
        """Show a photograph without points."""
        self._width_px = photo.width_px
        self.points = []
        self.show_pixels(photo.pixels)
        self.changed.emit()

    def forget_last(self) -> None:
        """Forget the last point."""
        self.points.pop()
        self.update()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take the point under the pointer, in pixels of the picture."""
        place = self.picture_place
        if event.button() != Qt.MouseButton.LeftButton or not place.contains(
            event.position().toPoint()
        ):
            return
        if len(self.points) > _TIP:
            self.points = []
        away = event.position() - QPointF(place.topLeft())
        scale = self._width_px / place.width()
        self.points.append((away.x() * scale, away.y() * scale))
        self.update()
        self.changed.emit()

    def paintEvent(self, event: QPaintEvent) -> None:
        """The picture, a ring at the foot, and an arrow's line to the tip."""
        super().paintEvent(event)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(_MARK), 2))
        place = self.picture_place
        corner, scale = QPointF(place.topLeft()), place.width() / self._width_px
        shown = [corner + QPointF(scale * x, scale * y) for x, y in self.points]
        for at in shown[:1]:
            painter.drawEllipse(at, _MARK_PX, _MARK_PX)
        if len(shown) > _TIP:
            painter.drawLine(shown[_FOOT], shown[_TIP])
            painter.setBrush(QColor(_MARK))
            painter.drawEllipse(shown[_TIP], _MARK_PX // 2, _MARK_PX // 2)

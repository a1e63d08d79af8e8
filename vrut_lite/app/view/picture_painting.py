"""Painting a picture and words over it."""

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter

from vrut_lite.app import theme

# Small pictures have their sizes rounded.
_ROUNDED = 0.02


def paint_picture(painter: QPainter, place: QRectF, image: QImage) -> None:
    """Paint a picture as high as a place, in its middle, and not stretched.

    A picture that was drawn for a wider or narrower place has the same angle of view from top to
    bottom: things stay where they are when the next one comes.
    """
    width = place.height() * image.width() / image.height()
    if abs(width - place.width()) < _ROUNDED * width:
        width = place.width()
    painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
    left = place.center().x() - 0.5 * width
    painter.drawImage(QRectF(left, place.top(), width, place.height()), image)


def write(painter: QPainter, place: QRectF, where: Qt.AlignmentFlag, text: str) -> None:
    """Write text with a shadow, legible on any picture; a narrow one has it in several lines."""
    flags = where.value | Qt.TextFlag.TextWordWrap.value
    painter.setPen(QColor(0, 0, 0, 170))
    painter.drawText(place.translated(1.0, 1.0), flags, text)
    painter.setPen(QColor(theme.TEXT))
    painter.drawText(place, flags, text)

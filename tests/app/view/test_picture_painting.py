"""Painting pictures into places of another shape."""

import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QImage, QPainter

from vrut_lite.app.view.picture_painting import paint_picture

BLACK, GREY, WHITE = (QColor(level, level, level) for level in (0, 128, 255))


def painted(place, image):
    canvas = QImage(place[0], place[1], QImage.Format.Format_RGB888)
    canvas.fill(BLACK)
    painter = QPainter(canvas)
    paint_picture(painter, QRectF(0, 0, *place), image)
    painter.end()
    return canvas


@pytest.mark.parametrize("place", [(40, 40), (80, 40), (160, 40), (80, 80)])
def test_a_picture_of_another_shape_is_not_stretched(qapp, place):
    """While a dock opens: a white square in the middle stays one, as high as before; a place that
    is wider than the picture is dark at its sides."""
    image = QImage(80, 40, QImage.Format.Format_RGB888)
    image.fill(GREY)
    for x in range(30, 50):
        for y in range(10, 30):
            image.setPixelColor(x, y, WHITE)
    canvas = painted(place, image)
    width, height = place
    scale = height / 40
    row = [canvas.pixelColor(x, height // 2).red() for x in range(width)]
    column = [canvas.pixelColor(width // 2, y).red() for y in range(height)]
    assert sum(level > 200 for level in row) == pytest.approx(20 * scale, abs=2)
    assert sum(level > 200 for level in column) == pytest.approx(20 * scale, abs=2)
    assert (row[1] < 20) is (width > 80 * scale)

"""The legend of a panel's false colours."""

from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from vrut_lite.app import theme
from vrut_lite.app.widgets import rgb_image
from vrut_lite.geometry.false_colours import scale_pixels

_BAR_PX, _LEGEND_PX = 10, 30


class Legend(QWidget):
    """The scale of colours, with values at its ends and in its middle."""

    def __init__(self) -> None:
        super().__init__()
        self.values: list[str] = []
        self.setFixedHeight(_LEGEND_PX)

    def show_values(self, values: list[str]) -> None:
        """Show the values of the darkest, middle and brightest colour; none hides the scale."""
        self.values = values
        self.setAccessibleName("scale: " + ", ".join(values) if values else "no scale")
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """A bar, and the values below it."""
        if not self.values:
            return
        painter = QPainter(self)
        painter.drawImage(QRect(0, 0, self.width(), _BAR_PX), rgb_image(scale_pixels(256)))
        painter.setPen(QColor(theme.TEXT))
        below = QRect(0, _BAR_PX, self.width(), _LEGEND_PX - _BAR_PX)
        sides = (
            Qt.AlignmentFlag.AlignLeft,
            Qt.AlignmentFlag.AlignHCenter,
            Qt.AlignmentFlag.AlignRight,
        )
        for value, side in zip(self.values, sides, strict=True):
            painter.drawText(below, side | Qt.AlignmentFlag.AlignVCenter, value)

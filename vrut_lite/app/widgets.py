"""Small parts of panels: forms, labels, timers, images."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QSize, Qt, QTimer
from PySide6.QtGui import QFontMetrics, QImage, QResizeEvent
from PySide6.QtWidgets import QComboBox, QFormLayout, QLabel, QVBoxLayout, QWidget

# Characters of an entry that a narrow drop-down shows.
_FEWEST_CHARACTERS = 6


def aligned_form(parent: QWidget | None = None) -> QFormLayout:
    """A form with vertically centred labels; fields take the free width, or the line below."""
    form = QFormLayout(parent)
    form.setLabelAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
    form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
    form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
    form.setHorizontalSpacing(12)
    form.setVerticalSpacing(6)
    return form


def panel_column(panel: QWidget) -> QVBoxLayout:
    """The layout of a panel, from top to bottom, with the margins of all panels."""
    column = QVBoxLayout(panel)
    column.setContentsMargins(10, 8, 8, 10)
    return column


def heading(text: str = "") -> QLabel:
    """A label in the theme's style of headings; a long one takes several lines."""
    label = _label(text, "heading")
    label.setWordWrap(True)
    return label


def faint_label(text: str = "", wraps: bool = False) -> QLabel:
    """A label in the theme's faint style."""
    label = _label(text, "faint")
    label.setWordWrap(wraps)
    return label


class Chooser(QComboBox):
    """A drop-down that may be narrower than its longest entry: a name must not widen a window."""

    def minimumSizeHint(self) -> QSize:
        """Room for the beginning of an entry, and the arrow."""
        hint = super().minimumSizeHint()
        least_px = _FEWEST_CHARACTERS * self.fontMetrics().averageCharWidth() + 40
        return QSize(min(hint.width(), least_px), hint.height())


class ShortenedLabel(QLabel):
    """A faint label of one line that may be narrower than its text, which then ends in dots.

    `setText` and `text` are of the whole text; the tooltip has it too.
    """

    def __init__(self) -> None:
        super().__init__()
        self._whole = ""
        self.setProperty("role", "faint")
        self.setMinimumWidth(1)

    def setText(self, text: str) -> None:
        """Show as much of a text as there is room for."""
        self._whole = text
        self.setToolTip(text)
        self._shorten()
        self.updateGeometry()

    def text(self) -> str:
        """The whole text."""
        return self._whole

    def sizeHint(self) -> QSize:
        """Room for the whole text."""
        hint = super().sizeHint()
        return QSize(QFontMetrics(self.font()).horizontalAdvance(self._whole) + 2, hint.height())

    def minimumSizeHint(self) -> QSize:
        """Any width will do."""
        return QSize(1, super().minimumSizeHint().height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Show more of the text, or less."""
        self._shorten()

    def _shorten(self) -> None:
        end = Qt.TextElideMode.ElideRight
        super().setText(QFontMetrics(self.font()).elidedText(self._whole, end, self.width()))


def make_timer(parent: QObject, ms: int, act: Callable[[], Any], once: bool = False) -> QTimer:
    """A timer that calls `act`, every `ms` milliseconds or once after each start; not started."""
    timer = QTimer(parent)
    timer.setSingleShot(once)
    timer.setInterval(ms)
    timer.timeout.connect(act)
    return timer


def rgb_image(pixels: NDArray[np.uint8]) -> QImage:
    """An image that owns its pixels (h, w, 3), sRGB."""
    height, width = pixels.shape[:2]
    data = np.ascontiguousarray(pixels)
    return QImage(data.data, width, height, 3 * width, QImage.Format.Format_RGB888).copy()


def _label(text: str, role: str) -> QLabel:
    label = QLabel(text)
    label.setProperty("role", role)
    return label

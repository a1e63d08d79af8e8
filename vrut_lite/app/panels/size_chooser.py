"""The size of an exported picture: the window's, a usual one, or any."""

from PySide6.QtWidgets import QHBoxLayout, QLabel, QSpinBox, QVBoxLayout, QWidget

from vrut_lite.app.widgets import Chooser

# A screen's, prints' and the web's; None: the picture in the window.
_USUAL: dict[str, tuple[int, int] | None] = {
    "as in the window": None,
    "1920 \N{MULTIPLICATION SIGN} 1080": (1920, 1080),
    "3840 \N{MULTIPLICATION SIGN} 2160": (3840, 2160),
    "2048 \N{MULTIPLICATION SIGN} 2048": (2048, 2048),
    "any size": (1600, 1000),
}
_ANY = "any size"
_SMALLEST_PX, _LARGEST_PX = 16, 8192


class SizeChooser(QWidget):
    """`size_px` is width and height in pixels, or None for those of the window."""

    def __init__(self) -> None:
        super().__init__()
        self.usual = Chooser()
        self.usual.setAccessibleName("size of the picture")
        self.usual.addItems(list(_USUAL))
        self.width_px, self.height_px = _pixels("width in pixels"), _pixels("height in pixels")
        self._typed = QWidget()
        row = QHBoxLayout(self._typed)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.width_px, 1)
        row.addWidget(QLabel("\N{MULTIPLICATION SIGN}"))
        row.addWidget(self.height_px, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.usual)
        column.addWidget(self._typed)
        self.setFocusProxy(self.usual)
        self.usual.currentTextChanged.connect(self._show_choice)
        self._show_choice(self.usual.currentText())

    @property
    def size_px(self) -> tuple[int, int] | None:
        """Width and height; None: as in the window."""
        if self.usual.currentText() == _ANY:
            return self.width_px.value(), self.height_px.value()
        return _USUAL[self.usual.currentText()]

    def choose(self, width_px: int, height_px: int) -> None:
        """Ask for any size."""
        self.usual.setCurrentText(_ANY)
        self.width_px.setValue(width_px)
        self.height_px.setValue(height_px)

    def _show_choice(self, choice: str) -> None:
        self._typed.setVisible(choice == _ANY)


def _pixels(name: str) -> QSpinBox:
    spin = QSpinBox()
    spin.setRange(_SMALLEST_PX, _LARGEST_PX)
    spin.setSuffix(" px")
    spin.setValue((_USUAL[_ANY] or (0, 0))[0 if name.startswith("width") else 1])
    spin.setAccessibleName(name)
    return spin

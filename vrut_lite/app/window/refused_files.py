"""The files that could not be opened or written, and why, as text to read, select and copy."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import (
    QDialog,
    QHBoxLayout,
    QLabel,
    QPlainTextEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

_WIDTH_PX, _HEIGHT_PX = 560, 240


class RefusedFiles(QDialog):
    """One dialog for all files that are refused while it is open; the window goes on beside it."""

    def __init__(self, window: QWidget):
        super().__init__(window)
        self.setWindowTitle("Refused files")
        self.setModal(False)
        self._window = window
        self.lines: list[str] = []
        self.heading = QLabel()
        self.text = QPlainTextEdit()
        self.text.setReadOnly(True)
        self.text.setAccessibleName("why files were refused")
        self.text.setTextInteractionFlags(
            Qt.TextInteractionFlag.TextSelectableByMouse
            | Qt.TextInteractionFlag.TextSelectableByKeyboard
        )
        self.copy = QPushButton("Copy")
        self.copy.setToolTip("Copy the whole text")
        self.copy.clicked.connect(lambda _: QGuiApplication.clipboard().setText(self.said))
        self.dismiss = QPushButton("Close")
        self.dismiss.setDefault(True)
        self.dismiss.clicked.connect(lambda _: self.reject())
        buttons = QHBoxLayout()
        buttons.addStretch(1)
        for button in (self.copy, self.dismiss):
            buttons.addWidget(button)
        column = QVBoxLayout(self)
        column.addWidget(self.heading)
        column.addWidget(self.text, 1)
        column.addLayout(buttons)
        self.resize(_WIDTH_PX, _HEIGHT_PX)

    @property
    def said(self) -> str:
        """The whole text, a sentence a file."""
        return "\n\n".join(self.lines)

    def add(self, line: str) -> None:
        """Tell why a file was refused; a sentence that is shown already is not repeated."""
        if line not in self.lines:
            self.lines.append(line)
        count = len(self.lines)
        self.heading.setText(
            "A file was refused:" if count == 1 else f"{count} files were refused:"
        )
        self.text.setPlainText(self.said)
        if self._window.isVisible():
            self.show()
            self.raise_()

    def done(self, result: int) -> None:
        """Empty the list when the dialog closes: the next refused file starts another one."""
        self.lines.clear()
        super().done(result)

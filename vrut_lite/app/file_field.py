"""A field for a file's path, with a button that lets one be chosen."""

from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QFileDialog, QHBoxLayout, QLineEdit, QToolButton, QWidget

from vrut_lite.app.icons import put_sign


class FileField(QWidget):
    """`kinds` is a filter of names, as "Pictures (*.png *.jpg)".

    `editingFinished` follows a typed path at the end of typing, and a chosen one at once.
    """

    editingFinished = Signal()

    def __init__(self, kinds: str):
        super().__init__()
        self._kinds = kinds
        self.line, self.browse = QLineEdit(), QToolButton()
        put_sign(self.browse, "browse")
        self.browse.setToolTip("Browse for a file")
        self.browse.setAccessibleName("browse for a file")
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addWidget(self.line, 1)
        row.addWidget(self.browse)
        self.setFocusProxy(self.line)
        self.line.editingFinished.connect(self.editingFinished)
        self.browse.clicked.connect(lambda _: self._choose())

    def text(self) -> str:
        """The path as it is shown."""
        return self.line.text()

    def setText(self, path: str) -> None:
        """Show a path."""
        self.line.setText(path)

    def _choose(self) -> None:
        known = self.text()
        folder = str(Path(known).parent) if known else ""
        path, _ = QFileDialog.getOpenFileName(self, "Choose a file", folder, self._kinds)
        if path:
            self.setText(path)
            self.editingFinished.emit()

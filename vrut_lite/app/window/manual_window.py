"""The manual in the user's browser, or in a window where no browser is installed."""

from pathlib import Path

from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QDialog, QTextBrowser, QVBoxLayout, QWidget


class ManualWindow(QDialog):
    """The manual's pages as text with links and pictures."""

    def __init__(self, start: Path, parent: QWidget | None = None):
        super().__init__(parent)
        self.setWindowTitle("Manual")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.page = QTextBrowser()
        self.page.setAccessibleName("manual")
        self.page.setOpenExternalLinks(True)
        self.page.setSource(QUrl.fromLocalFile(str(start)))
        column = QVBoxLayout(self)
        column.addWidget(self.page)
        self.resize(900, 640)


def show_manual(start: Path, parent: QWidget) -> None:
    """Open the manual's start page."""
    if not QDesktopServices.openUrl(QUrl.fromLocalFile(str(start))):
        ManualWindow(start, parent).show()

"""The dialog *Help, About*: this installation, and its lines for a bug report."""

from PySide6.QtCore import Qt, qVersion
from PySide6.QtGui import QFontDatabase, QGuiApplication
from PySide6.QtWidgets import (
    QDialog,
    QHBoxLayout,
    QPlainTextEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from vrut_lite import __version__
from vrut_lite.about import about_text
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.widgets import faint_label, heading


def graphics_of(stage: Stage) -> str:
    """The stage's renderer with its driver's version; on the engine's thread."""
    version = f", OpenGL {stage.device.version}" if stage.device is not None else ""
    return f"{stage.renderer}{version}"


class AboutBox(QDialog):
    """Versions, graphics, folders and licences; a button copies them."""

    def __init__(self, graphics: str, parent: QWidget | None = None):
        super().__init__(parent)
        self.setWindowTitle("About vrut_lite")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        screen = QGuiApplication.platformName()
        self.text = f"{about_text(graphics)}\nQt {qVersion()} on {screen}"
        column = QVBoxLayout(self)
        column.addWidget(heading(f"vrut_lite {__version__}"))
        column.addWidget(faint_label("Scenes under the sky of a place and an hour", wraps=True))
        facts = QPlainTextEdit(self.text)
        facts.setReadOnly(True)
        facts.setAccessibleName("versions, graphics, folders and licences")
        facts.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        column.addWidget(facts, 1)
        row = QHBoxLayout()
        self.copies = QPushButton("Copy for a bug report")
        self.copies.clicked.connect(self._copy)
        closes = QPushButton("Close")
        closes.clicked.connect(self.close)
        row.addWidget(self.copies)
        row.addStretch(1)
        row.addWidget(closes)
        column.addLayout(row)
        self.resize(680, 520)

    def _copy(self) -> None:
        QGuiApplication.clipboard().setText(self.text)
        self.copies.setText("Copied")

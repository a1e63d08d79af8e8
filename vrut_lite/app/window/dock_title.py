"""The title of a dock: its name where no tab shows it, and a button that closes it."""

from PySide6.QtWidgets import QDockWidget, QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from vrut_lite.app.icons import put_sign
from vrut_lite.app.widgets import faint_label

_SIGN_PX = 14


class DockTitle(QWidget):
    """A low bar above a dock; `beside` stands left of it instead, without the name.

    The menu opens an `advanced` dock again elsewhere than others.
    """

    def __init__(self, dock: QDockWidget, beside: bool = False, advanced: bool = False):
        super().__init__(dock)
        self._dock, self._beside = dock, beside
        self.name: QLabel = faint_label(dock.windowTitle())
        self.close_button = QToolButton()
        put_sign(self.close_button, "close", _SIGN_PX)
        self.close_button.setProperty("flat", True)
        menu = "Advanced" if advanced else "Panels"
        self.close_button.setToolTip(f"Close {dock.windowTitle()}; View, {menu} opens it again")
        self.close_button.setAccessibleName(f"close {dock.windowTitle()}")
        self.close_button.clicked.connect(dock.hide)
        if beside:
            self.name.setParent(self)
            self.name.hide()
            column = QVBoxLayout(self)
            column.setContentsMargins(2, 4, 0, 0)
            column.addWidget(self.close_button)
            column.addStretch(1)
            return
        row = QHBoxLayout(self)
        row.setContentsMargins(8, 0, 4, 0)
        row.addWidget(self.name)
        row.addStretch(1)
        row.addWidget(self.close_button)

    def show_name(self, shown: bool) -> None:
        """Show the dock's name, or leave that to its tab."""
        self.name.setVisible(shown and not self._beside)

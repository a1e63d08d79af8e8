"""The panel: the latest values, and the whole log as a file.

The window imports it by the entry point `vrut_lite.panels`; nothing else here imports Qt.
"""

from collections import deque
from pathlib import Path

from PySide6.QtWidgets import (
    QFileDialog,
    QHBoxLayout,
    QHeaderView,
    QPushButton,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)
from vrut_lite.panel_kit import Session, faint_label, panel_column

from new_tool.log import LuxLogged, as_csv

# Values in the log, of which the oldest go, and rows that are shown.
_MOST_VALUES, _MOST_ROWS = 100_000, 200


class NewToolPanel(QWidget):
    """Lists what the module posts while the window is open."""

    title = "New tool"

    def __init__(self, session: Session):
        super().__init__()
        self.values: deque[LuxLogged] = deque(maxlen=_MOST_VALUES)
        self.list = QTreeWidget()
        self.list.setAccessibleName("illuminance of level ground")
        self.list.setHeaderLabels(["Time (UTC)", "lx", "lx by the sky"])
        self.list.setRootIsDecorated(False)
        self.list.setUniformRowHeights(True)
        self.list.header().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self.save, self.clear = QPushButton("Save as CSV..."), QPushButton("Clear")
        self.status = faint_label("No value so far: move the hour.", wraps=True)
        buttons = QHBoxLayout()
        buttons.addWidget(self.save)
        buttons.addWidget(self.clear)
        column = panel_column(self)
        column.addWidget(self.list, 1)
        column.addLayout(buttons)
        column.addWidget(self.status)
        self.save.clicked.connect(lambda _: self._choose_file())
        self.clear.clicked.connect(lambda _: self.forget())
        session.listen(LuxLogged, self._show)

    def write(self, path: Path) -> None:
        """Write the log to a file."""
        try:
            path.write_text(as_csv(self.values), encoding="utf-8")
        except OSError as error:
            self.status.setText(f"{path} cannot be written: {error.strerror}")
        else:
            self.status.setText(f"{path}: {len(self.values)} values")

    def forget(self) -> None:
        """Begin the log again."""
        self.values.clear()
        self.list.clear()
        self.status.setText("No value so far: move the hour.")

    def _show(self, logged: LuxLogged) -> None:
        self.values.append(logged)
        time = f"{logged.instant:%Y-%m-%d %H:%M}"
        row = QTreeWidgetItem([time, lux_text(logged.total_lx), lux_text(logged.sky_lx)])
        self.list.insertTopLevelItem(0, row)
        if self.list.topLevelItemCount() > _MOST_ROWS:
            self.list.takeTopLevelItem(_MOST_ROWS)
        self.status.setText(f"{len(self.values)} values")

    def _choose_file(self) -> None:
        name, _ = QFileDialog.getSaveFileName(self, "Save the log", "lux.csv", "Tables (*.csv)")
        if name:
            self.write(Path(name))


def lux_text(lux: float) -> str:
    """An illuminance as people write it: whole from 100 lx on, three digits below."""
    return f"{lux:,.0f}" if lux >= 100.0 else f"{lux:.3g}"

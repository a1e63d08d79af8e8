"""A module's panel, made from its settings."""

from functools import partial
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QInputDialog,
    QMenu,
    QPushButton,
    QToolButton,
    QWidget,
)

from vrut_lite.app.engine.module_catalogue import ModuleInfo
from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.presets import PresetStore, Values
from vrut_lite.app.panels.setting_row import SettingRow
from vrut_lite.app.widgets import faint_label, heading, panel_column
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Fault, SetSetting, SettingChanged
from vrut_lite.messages.ground import SetGround, ground_of
from vrut_lite.messages.haze import SetHaze, haze_of
from vrut_lite.messages.scene import SceneOpened


class ModulePanel(QWidget):
    """A row for each setting; presets and reset for all of them.

    `remade` emits the widget that holds the rows when a reload has changed the settings.
    """

    remade = Signal(QWidget)

    def __init__(self, session: Session, module: str, presets: PresetStore):
        super().__init__()
        self._session, self._name, self._presets = session, module, presets
        self._specs = self._module.specs
        self.rows: dict[str, SettingRow] = {}
        column = panel_column(self)
        column.addLayout(self._heading())
        self._settings = self._grid()
        column.addWidget(self._settings)
        column.addStretch(1)
        self._show_left_open()
        self._show_resettable()
        session.listen(SettingChanged, self._changed)
        for kind in (SetHaze, SetGround, SceneOpened):
            session.listen(kind, lambda _: self._show_left_open())
        session.listen(Fault, self._refused)
        session.catalogue_renewed.connect(self._renew)

    @property
    def _module(self) -> ModuleInfo:
        return self._session.catalogue.modules[self._name]

    @property
    def title(self) -> str:
        """The module's title."""
        return self._module.title

    def choose(self, values: Values) -> None:
        """Ask for these values of the settings."""
        self._session.send(
            *(
                SetSetting(module=self._name, name=name, value=value)
                for name, value in values.items()
                if name in self.rows and value != self._module.values[name]
            )
        )

    def _heading(self) -> QHBoxLayout:
        title = heading(self._module.title)
        title.setToolTip(f"{self._name} {self._module.version}")
        self.presets = QToolButton()
        self.presets.setText("Presets")
        self.presets.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.preset_menu = QMenu(self.presets)
        self.preset_menu.aboutToShow.connect(self.fill_presets)
        self.preset_menu.setToolTipsVisible(True)
        self.presets.setMenu(self.preset_menu)
        self.reset = QPushButton("Reset")
        self.reset.setToolTip("All settings of this module to their defaults")
        self.reset.clicked.connect(lambda: self.choose(self._defaults()))
        row = QHBoxLayout()
        row.addWidget(title, 1)
        row.addWidget(self.presets)
        row.addWidget(self.reset)
        return row

    def _grid(self) -> QWidget:
        rows = QWidget()
        grid = QGridLayout(rows)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(6)
        grid.setColumnStretch(1, 1)
        for number, (name, spec) in enumerate(self._specs.items()):
            row = SettingRow(spec, self._module.values[name], self)
            row.put_in(grid, number)
            row.edited.connect(lambda value, name=name: self._send(name, value))
            self.rows[name] = row
        if not self.rows:
            grid.addWidget(faint_label("Nothing to set."), 0, 0, Qt.AlignmentFlag.AlignLeft)
        return rows

    def _defaults(self) -> Values:
        return {name: spec.default for name, spec in self._specs.items()}

    def _send(self, name: str, value: Any) -> None:
        self._session.send(SetSetting(module=self._name, name=name, value=value))

    def _changed(self, message: SettingChanged) -> None:
        if message.module == self._name and message.name in self.rows:
            if message.value is not None:
                self.rows[message.name].show_value(message.value)
            # One setting may say what others stand for: a preset does.
            self._show_left_open()
            self._show_resettable()

    def _show_left_open(self) -> None:
        """Show what unset settings stand for."""
        known = self._module.left_open(haze_of(self._session), ground_of(self._session))
        for name, row in self.rows.items():
            if self._module.values[name] is None:
                row.show_value(None, known.get(name))

    def _show_resettable(self) -> None:
        self.reset.setEnabled(bool(self._module.changed_values))

    def _renew(self) -> None:
        """A newer version may have other settings."""
        if self._module.specs == self._specs:
            return
        self._specs = self._module.specs
        self.rows.clear()
        old, self._settings = self._settings, self._grid()
        layout = self.layout()
        assert layout is not None
        layout.replaceWidget(old, self._settings)
        old.deleteLater()
        self._show_left_open()
        self._show_resettable()
        self.remade.emit(self._settings)

    def _refused(self, fault: Fault) -> None:
        """Show the setting's value again after a refused one."""
        if fault.module == self._name:
            for name, row in self.rows.items():
                if self._module.values[name] is not None:
                    row.show_value(self._module.values[name])
            self._show_left_open()

    # --- presets -----------------------------------------------------------------------------

    def fill_presets(self) -> None:
        """Fill the menu with the presets that are kept."""
        self.preset_menu.clear()
        self.preset_menu.addAction("Defaults", lambda: self.choose(self._defaults()))
        for title, preset in self._module.presets.items():
            values = {**self._defaults(), **preset.values}
            self.preset_menu.addAction(title, partial(self.choose, values)).setToolTip(preset.line)
        names = self._presets.names(self._name)
        if names:
            self.preset_menu.addSeparator()
        for name in names:
            self.preset_menu.addAction(name, partial(self._use, name))
        self.preset_menu.addSeparator()
        self.preset_menu.addAction("Keep these settings\N{HORIZONTAL ELLIPSIS}", self._ask_to_keep)
        if names:
            dropping = self.preset_menu.addMenu("Forget")
            for name in names:
                dropping.addAction(name, partial(self._forget, name))

    def keep(self, name: str) -> None:
        """Save the present settings under a name."""
        self._guarded(lambda: self._presets.keep(self._name, name, self._module.values))

    def _use(self, name: str) -> None:
        self.choose({**self._defaults(), **self._presets.values(self._name, name)})

    def _forget(self, name: str) -> None:
        self._guarded(lambda: self._presets.forget(self._name, name))

    def _ask_to_keep(self) -> None:
        name, wanted = QInputDialog.getText(self, "Keep settings", "Name of the preset:")
        if wanted and name.strip():
            self.keep(name.strip())

    def _guarded(self, act: Any) -> None:
        try:
            act()
        except UserError as error:
            self._session.problem.emit(str(error))

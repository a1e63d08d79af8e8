"""The holders of the slots, and the settings of the holder of the sky."""

import msgspec
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from vrut_lite.app import theme
from vrut_lite.app.engine.module_catalogue import ModuleCatalogue, ModuleInfo
from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.haze_field import HazeField
from vrut_lite.app.panels.module_panel import ModulePanel
from vrut_lite.app.panels.number_field import NumberField
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.widgets import Chooser, aligned_form, faint_label
from vrut_lite.kernel.messages import ChooseSlot, Fault, SlotChanged
from vrut_lite.messages.ground import (
    DEFAULT_GROUND,
    GROUND_NAMES,
    NO_DISC,
    SCENE_BORDER,
    SetGround,
)
from vrut_lite.messages.haze import AEROSOL_TYPES, DEFAULT_HAZE, SetHaze
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE, SetTolerance

SHOWN_SLOT = "sky"
_EMPTY = "none"
_GROUNDS = {
    SCENE_BORDER: "As the scene's border",
    **{name: name.capitalize() for name in GROUND_NAMES if name not in (SCENE_BORDER, NO_DISC)},
    NO_DISC: "None",
}
_LOWEST_PERCENT = 0.1


class SkyPanel(QWidget):
    """A chooser for each slot that several modules can hold, haze, ground and tolerance."""

    def __init__(self, session: Session, presets: PresetStore):
        super().__init__()
        self._session, self._presets = session, presets
        self.choosers: dict[str, Chooser] = {}
        self.panels: dict[str, ModulePanel] = {}
        self.haze = HazeField(
            "Haze above the place. A sky whose settings name a turbidity or bring a preset has "
            "its own"
        )
        self.haze.setAccessibleName("haze")
        self.aerosol = Chooser()
        self.aerosol.setAccessibleName("aerosol")
        for name in AEROSOL_TYPES:
            self.aerosol.addItem(name.replace("-", " ").capitalize(), name)
        self.aerosol.setToolTip(
            "What the haze is made of: a type of OPAC (Hess, Koepke and Schult 1998), or one lobe "
            "for all colours. A sky that solves the atmosphere shows it; a fast one may know "
            "continental haze alone"
        )
        self.ground = Chooser()
        self.ground.setAccessibleName("ground")
        for name, title in _GROUNDS.items():
            self.ground.addItem(title, name)
        self.ground.setToolTip(
            "What lies around the scene up to the horizon, and lights the sky from below. A sky "
            "whose settings name an albedo or bring a preset has its own"
        )
        self.tolerance = NumberField(_LOWEST_PERCENT, 100.0, "%", decimals=2)
        self.tolerance.show_value(100.0 * DEFAULT_TOLERANCE)
        self.tolerance.setAccessibleName("tolerance")
        self.tolerance.setToolTip(
            "Allowed relative error of radiance in 99 of 100 directions: sizes, orders and "
            "thresholds follow (docs/tolerance.md)"
        )
        self._choices = aligned_form()
        self._choices.setContentsMargins(10, 10, 10, 0)
        # Until the modules are there.
        self.coming = faint_label("Opening the skies\N{HORIZONTAL ELLIPSIS}")
        self._choices.addRow(self.coming)
        self.lack = QLabel()
        self.lack.setWordWrap(True)
        self.lack.setContentsMargins(10, 4, 10, 0)
        self.lack.setStyleSheet(f"color: {theme.ALARM};")
        self.lack.setVisible(False)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(self._choices)
        column.addWidget(self.lack)
        # One panel is seen at a time, and it alone counts for the width.
        self._settings = QVBoxLayout()
        column.addLayout(self._settings, 1)
        self.haze.edited.connect(lambda depth: self._change_haze(optical_depth_550=depth))
        self.aerosol.activated.connect(lambda _: self._change_aerosol())
        self.ground.activated.connect(
            lambda _: session.send(SetGround(ground=self.ground.currentData()))
        )
        session.listen(SetGround, self._show_ground)
        self._show_ground(DEFAULT_GROUND)
        session.listen(SetHaze, self._show_haze)
        self._show_haze(DEFAULT_HAZE)
        self.tolerance.edited.connect(
            lambda percent: session.send(SetTolerance(tolerance=percent / 100.0))
        )
        session.listen(SetTolerance, lambda m: self.tolerance.show_value(100.0 * m.tolerance))
        session.ready.connect(self._fill)
        for kind in (SlotChanged, Fault):
            session.listen(kind, lambda _: self._show_holders())

    def _fill(self, catalogue: ModuleCatalogue) -> None:
        self._choices.removeRow(self.coming)
        # A slot that one module alone can hold needs no chooser.
        contested = [slot for slot in catalogue.slots if len(catalogue.providers(slot)) > 1]
        for slot in sorted(contested, key=lambda slot: (slot != SHOWN_SLOT, slot)):
            chooser = Chooser()
            chooser.setAccessibleName(slot.replace("_", " "))
            chooser.setPlaceholderText(_EMPTY)
            for module in catalogue.providers(slot):
                add_module(chooser, module)
            chooser.activated.connect(lambda _, slot=slot: self._choose(slot))
            self.choosers[slot] = chooser
            self._choices.addRow(QLabel(slot.replace("_", " ").capitalize()), chooser)
        self._choices.addRow("Haze", self.haze)
        self._choices.addRow("Aerosol", self.aerosol)
        self._choices.addRow("Ground", self.ground)
        self._choices.addRow("Tolerance", self.tolerance)
        for module in catalogue.providers(SHOWN_SLOT):
            panel = ModulePanel(self._session, module.name, self._presets)
            panel.hide()
            self.panels[module.name] = panel
            self._settings.addWidget(panel)
        self._show_holders()

    def _change_haze(self, **changes: object) -> None:
        """Set a part of the haze, and leave the rest."""
        known = self._session.last(SetHaze) or DEFAULT_HAZE
        self._session.send(msgspec.structs.replace(known, **changes))

    def _change_aerosol(self) -> None:
        self._change_haze(aerosol=self.aerosol.currentData(), own=None)

    def _show_haze(self, haze: SetHaze) -> None:
        self.haze.show_value(haze.optical_depth_550)
        # A user's aerosol is not in this list.
        known = haze.aerosol if haze.own is None else None
        self.aerosol.setCurrentIndex(self.aerosol.findData(known))

    def _show_ground(self, ground: SetGround) -> None:
        self.ground.setCurrentIndex(self.ground.findData(ground.ground))

    def _choose(self, slot: str) -> None:
        module = self.choosers[slot].currentData()
        if module:
            self._session.send(ChooseSlot(slot=slot, module=module))

    def _show_holders(self) -> None:
        """Show the holders, also after a choice that was refused."""
        for slot, holder in self._session.catalogue.holders.items():
            if slot in self.choosers:
                self._show(slot, holder)
        empty = [slot for slot, holder in self._session.catalogue.holders.items() if not holder]
        self.lack.setText(lack_line(sorted(empty)))
        self.lack.setVisible(bool(empty))

    def _show(self, slot: str, holder: str) -> None:
        chooser = self.choosers[slot]
        chooser.setCurrentIndex(chooser.findData(holder) if holder else -1)
        chooser.setToolTip(
            f"{holder}: its name in scripts, projects and journals" if holder else ""
        )
        if slot == SHOWN_SLOT and holder in self.panels:
            for name, panel in self.panels.items():
                panel.setVisible(name == holder)


def add_module(chooser: Chooser, module: ModuleInfo) -> None:
    """Add a module by its title; its tooltip is the name that scripts use."""
    chooser.addItem(module.title, module.name)
    chooser.setItemData(chooser.count() - 1, module.name, Qt.ItemDataRole.ToolTipRole)


def lack_line(slots: list[str]) -> str:
    """The consequence of slots without a holder, in a sentence; empty without such slots."""
    if not slots:
        return ""
    named = " and no ".join(slot.replace("_", " ") for slot in slots)
    return (
        f"There is no {named} now: no module that runs gives it, and its light is missing. Choose "
        "one here, or switch one on in Modules (F4)."
    )

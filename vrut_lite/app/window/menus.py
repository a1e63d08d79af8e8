"""The menus, made from the list of actions."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMenu

from vrut_lite.app.engine.history import Steps
from vrut_lite.app.window.actions import ACTIONS, ActionSpec

if TYPE_CHECKING:
    from vrut_lite.app.window.main_window import MainWindow

_RECENT_AFTER = "open"


class Menus:
    """`actions` by name, and the menus that are filled as the window grows."""

    def __init__(self, window: "MainWindow", recent: Callable[[], list[str]]):
        self.actions: dict[str, QAction] = {}
        self._window = window
        self._recent = recent
        menus: dict[str, QMenu] = {}
        groups: dict[str, QActionGroup] = {}
        for spec in ACTIONS:
            if spec.menu not in menus:
                menus[spec.menu] = window.menuBar().addMenu(spec.menu)
            action = self._action(spec)
            menus[spec.menu].addAction(action)
            if spec.group:
                groups.setdefault(spec.group, QActionGroup(window)).addAction(action)
            if spec.name == _RECENT_AFTER:
                self.recent = menus[spec.menu].addMenu("Open recent")
        self.recent.aboutToShow.connect(self.fill_recent)
        self.panels = menus["View"].addMenu("Panels")
        self.actions["orbit"].setChecked(True)
        self.show_steps(Steps())

    def show_steps(self, steps: Steps) -> None:
        """Name what can be taken back and done again."""
        for name, verb, title in (("undo", "Undo", steps.undo), ("redo", "Redo", steps.redo)):
            self.actions[name].setText(f"{verb} {title}".rstrip())
            self.actions[name].setEnabled(bool(title))

    def fill_recent(self) -> None:
        """List the files that were opened lately and still are there."""
        self.recent.clear()
        for number, path in enumerate(self._recent(), 1):
            file = Path(path)
            title = f"&{number % 10}  {file.name}   {file.parent}"
            self.recent.addAction(title, partial(self._window.open_path, path))
        if self.recent.isEmpty():
            self.recent.addAction("nothing yet").setEnabled(False)

    def _action(self, spec: ActionSpec) -> QAction:
        action = QAction(spec.title, self._window)
        action.setShortcuts([QKeySequence(keys) for keys in spec.keys.split(", ")])
        action.setCheckable(spec.checkable)
        action.triggered.connect(lambda on: spec.act(self._window, bool(on)))
        self.actions[spec.name] = action
        return action

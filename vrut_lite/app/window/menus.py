"""The menus, made from a list of actions."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu

from vrut_lite.app.engine.history import Steps
from vrut_lite.app.window.actions import ENTER_VR, LEAVE_VR, ActionSpec
from vrut_lite.bundled.examples import all_examples
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import SettingChanged
from vrut_lite.messages.picture import SetExposure

_RECENT_AFTER = "open"
_ADVANCED = "Advanced"


class Menus:
    """The menus of a window; `actions` by name, and the `specs` that they are made from."""

    def __init__(
        self,
        window: QMainWindow,
        specs: list[ActionSpec],
        recent: Callable[[], list[str]],
        open_path: Callable[[str], None],
    ):
        self.actions: dict[str, QAction] = {}
        self.specs: list[ActionSpec] = []
        self._window = window
        self._recent, self._open_path = recent, open_path
        self._menus: dict[str, QMenu] = {}
        self._groups: dict[str, QActionGroup] = {}
        self._letters: dict[str, set[str]] = {}
        self.advanced = QMenu(_ADVANCED, window)
        for spec in specs:
            self.add(spec)
            if spec.name == _RECENT_AFTER:
                self.recent = self._submenu(spec.menu, "Open recent")
                self.examples = self._submenu(spec.menu, "Examples")
        self.recent.aboutToShow.connect(self.fill_recent)
        self.examples.aboutToShow.connect(self.fill_examples)
        self.views = self._submenu("Camera", "Views")
        self.panels = self._submenu("View", "Panels")
        self.advanced.setTitle(self._with_letter("View", _ADVANCED))
        self._menus["View"].addMenu(self.advanced)
        self.actions["orbit"].setChecked(True)
        self.actions["show picture"].setChecked(True)
        self.show_steps(Steps())

    def add(self, spec: ActionSpec, before: str = "") -> None:
        """Append an action to its menu, or put it before the one of that name."""
        if spec.menu not in self._menus:
            self._menus[spec.menu] = self._window.menuBar().addMenu(f"&{spec.menu}")
        menu = self._menus[spec.menu]
        if spec.advanced:
            menu = self.advanced
        action = self._action(spec)
        if before:
            menu.insertAction(self.actions[before], action)
        else:
            menu.addAction(action)
        if spec.group:
            self._groups.setdefault(spec.group, QActionGroup(self._window)).addAction(action)
        self.specs.append(spec)

    def show_steps(self, steps: Steps) -> None:
        """Show the titles of the steps to undo and redo."""
        for name, verb, title in (("undo", "Undo", steps.undo), ("redo", "Redo", steps.redo)):
            self.actions[name].setText(f"&{verb} {title}".rstrip())
            self.actions[name].setEnabled(bool(title))

    def show_vr(self, is_on: bool) -> None:
        """Show whether a headset shows the scene."""
        self.actions["vr"].setText(LEAVE_VR if is_on else ENTER_VR)

    def show_exposure(self, exposure: SetExposure) -> None:
        """Show whether the exposure is locked."""
        locked = exposure.mode == "manual"
        self.actions["lock exposure"].setChecked(locked)
        self.actions["meter exposure"].setEnabled(not locked)

    def show_section(self, changed: SettingChanged) -> None:
        """Show whether the picture is cut."""
        if (changed.module, changed.name) == ("scene", "section"):
            self.actions["section"].setChecked(changed.value != "off")

    def show_values(self, changed: SettingChanged) -> None:
        """Show whether the picture is one of values in false colours."""
        if (changed.module, changed.name) == ("scene", "shows"):
            self.actions[f"show {changed.value}"].setChecked(True)

    def fill_recent(self) -> None:
        """List the recent files that exist."""
        self.recent.clear()
        for number, path in enumerate(self._recent(), 1):
            file = Path(path)
            title = f"&{number % 10}  {file.name}   {file.parent}"
            self.recent.addAction(title, partial(self._open_path, path))
        if self.recent.isEmpty():
            self.recent.addAction("nothing yet").setEnabled(False)

    def fill_examples(self) -> None:
        """List the scenes that come with the program."""
        self.examples.clear()
        try:
            scenes = [one for one in all_examples().values() if one.kind == "scene"]
        except UserError as error:
            self.examples.addAction(str(error)).setEnabled(False)
            return
        for example in scenes:
            open_it = partial(self._open_path, str(example.opens))
            self.examples.addAction(example.title, open_it)

    def _submenu(self, menu: str, title: str) -> QMenu:
        return self._menus[menu].addMenu(self._with_letter(menu, title))

    def _with_letter(self, menu: str, title: str) -> str:
        """The title with a mark before the first letter that no other entry of the menu has."""
        taken = self._letters.setdefault(menu, set())
        for place, letter in enumerate(title.lower()):
            if letter.isalpha() and letter not in taken:
                taken.add(letter)
                return f"{title[:place]}&{title[place:]}"
        return title

    def _action(self, spec: ActionSpec) -> QAction:
        menu = _ADVANCED if spec.advanced else spec.menu
        action = QAction(self._with_letter(menu, spec.title), self._window)
        action.setShortcuts([QKeySequence(keys) for keys in spec.keys.split(", ")])
        action.setCheckable(spec.checkable)
        action.triggered.connect(lambda on: spec.act(bool(on)) if spec.checkable else spec.act())
        self.actions[spec.name] = action
        return action

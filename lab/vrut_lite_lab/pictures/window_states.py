"""Every main state of the window as the screen shows it, to look at by eye.

    xvfb-run -a -s "-screen 0 1366x768x24" \\
        python -m vrut_lite_lab.pictures.window_states FOLDER [NAME ...]

Writes NAME.png of all states, or of those that are named. The window is placed as a first one is:
the screen's size decides. QT_SCALE_FACTOR=2 tries twice the pixels.
"""

import argparse
import os
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import monotonic

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from path_tracer.panel import TracedPanel
from PySide6.QtWidgets import QApplication, QComboBox, QMenu, QWidget

from vrut_lite.app.theme import apply_theme
from vrut_lite.app.window.first_size import first_place
from vrut_lite.app.window.shortcut_list import ShortcutList
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.messages.scene import LoadScene
from vrut_lite_lab.pictures.drawing import scene_project
from vrut_lite_lab.pictures.posed_window import PosedWindow

_NOON, _NIGHT = "2026-06-21T13:00", "2026-06-21T23:30"
_TRACED_PATHS = 4
# Until the loading state has been painted.
_PAINTED_S = 0.3


class Tour:
    """Leads one window from state to state; `see(name)` keeps the whole screen."""

    def __init__(self, posed: PosedWindow, folder: Path, wanted: list[str]):
        self.posed, self.window = posed, posed.window
        self._folder, self._wanted = folder, wanted

    def wants(self, name: str) -> bool:
        """Whether a state is to be seen."""
        return not self._wanted or name in self._wanted

    def see(self, name: str) -> None:
        """Keep what the screen shows."""
        self.posed.rest()
        self._keep(name)

    def _keep(self, name: str) -> None:
        screen = QApplication.primaryScreen()
        screen.grabWindow(0).save(str(self._folder / f"{name}.png"))

    def run(self) -> None:
        """All states, or those that are wanted."""
        states: dict[str, Callable[[str], None]] = {
            "loading": self._loading, "street": self._street, "menu": self._menu,
            "drop_down": self._drop_down, "palette": self._palette, "keys": self._keys,
            "sun_path": self._sun_path, "section": self._section, "traced": self._traced,
            "refused": self._refused, "unsaved": self._unsaved, "genera": self._genera,
        }  # fmt: skip
        for dock in self.window.docks:
            states[f"dock_{dock.replace(' ', '_')}"] = partial(self._dock, dock=dock)
        states["night"] = self._night
        for name, show in states.items():
            if self.wants(name):
                show(name)

    def _loading(self, name: str) -> None:
        path = scene_project("street.toml").scene
        self.posed.session.send(LoadScene(path=path))
        self.window.desk.viewport.loading.begin(path)
        began_s = monotonic()
        self.posed.until(lambda: monotonic() > began_s + _PAINTED_S)
        self._keep(name)

    def _street(self, name: str) -> None:
        self.posed.open(scene_project("street.toml", at=_NOON))
        self.see(name)

    def _night(self, name: str) -> None:
        self.posed.open(scene_project("street.toml", at=_NIGHT))
        self.see(name)

    def _dock(self, name: str, dock: str) -> None:
        was_hidden = self.window.docks[dock].isHidden()
        self.window.show_dock(dock)
        self.posed.finish()
        self.see(name)
        if was_hidden:
            self.window.docks[dock].hide()

    def _traced(self, name: str) -> None:
        panel = self.window.panels["panel path_tracer"]
        assert isinstance(panel, TracedPanel)
        self.posed.session.send(SetSetting(module="path_tracer", name="spp", value=_TRACED_PATHS))
        self.window.show_dock("panel path_tracer")
        self.posed.until(lambda: panel.shown is not None and panel.shown.samples == _TRACED_PATHS)
        self.posed.finish()
        self.see(name)
        self.window.docks["panel path_tracer"].hide()

    def _menu(self, name: str) -> None:
        """Each menu and submenu, in a picture of its own."""
        for menu in (*self.window.menuBar().findChildren(QMenu), self.window.menus.advanced):
            title = menu.title().replace("&", "").replace(" ", "_").lower()
            # Qt has one more, without a title, for a bar that is too narrow.
            if title and menu.actions():
                self._while_open(f"{name}_{title}", menu)

    def _refused(self, name: str) -> None:
        refused = self.window.files.refused
        for file in ("no scene.glb", "no project.toml"):
            self.window.files.open_path(str(self._folder / file))
        self.posed.until(lambda: len(refused.lines) == 2)
        self.see(name)
        refused.reject()

    def _unsaved(self, name: str) -> None:
        files = self.window.files
        files.save(str(self._folder / "evening.toml"))
        self.posed.session.send(SetSetting(module="scene", name="light_shafts", value=True))
        self.posed.finish(anew=True)
        self.window.close()
        self.see(name)
        assert files.question is not None
        files.question.reject()
        files.project = None

    def _genera(self, name: str) -> None:
        palette = self.window.new_palette()
        palette.text_field.setText("cumulus")
        self._while_open(name, palette)

    def _while_open(self, name: str, part: QWidget) -> None:
        if isinstance(part, QMenu):
            part.popup(self.window.mapToGlobal(self.window.menuBar().geometry().bottomLeft()))
        else:
            part.show()
        self.see(name)
        part.close()

    def _drop_down(self, name: str) -> None:
        self.window.show_dock("sky")
        self.posed.rest()
        boxes = self.window.panels["sky"].findChildren(QComboBox)
        shown = next(box for box in boxes if not box.visibleRegion().isEmpty())
        shown.showPopup()
        self.see(name)
        shown.hidePopup()

    def _palette(self, name: str) -> None:
        palette = self.window.new_palette()
        palette.text_field.setText("sun")
        self._while_open(name, palette)

    def _keys(self, name: str) -> None:
        self._while_open(name, ShortcutList(self.window.menus.specs, self.window))

    def _sun_path(self, name: str) -> None:
        actions = self.window.actions_by_name
        for action in ("sun path", "compass"):
            actions[action].trigger()
        self.posed.finish()
        self.see(name)
        for action in ("sun path", "compass"):
            actions[action].trigger()

    def _section(self, name: str) -> None:
        action = self.window.actions_by_name["section"]
        self.posed.open(scene_project("pavilion.gltf", at=_NOON))
        self.window.show_dock("module scene")
        action.trigger()
        self.posed.finish(anew=True)
        self.see(name)
        action.trigger()


def main() -> None:
    """Write all states, or those that are named."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    chosen = parser.parse_args()
    chosen.folder.mkdir(parents=True, exist_ok=True)
    app = QApplication([])
    apply_theme(app)
    free = app.primaryScreen().availableGeometry()
    with tempfile.TemporaryDirectory() as presets:
        posed = PosedWindow(
            app, Path(presets), scene_project("street.toml", at=_NOON), first_place(free)
        )
        try:
            Tour(posed, chosen.folder, chosen.names).run()
        finally:
            posed.window.close_now()
            posed.session.join()


if __name__ == "__main__":
    main()

"""The actions of menus and keys, in one list."""

from collections.abc import Callable
from typing import NamedTuple

from PySide6.QtWidgets import QFileDialog

from vrut_lite.app.engine.session_project import folder_of
from vrut_lite.app.view.viewport import CameraMode
from vrut_lite.app.window.commanded_window import CommandedWindow
from vrut_lite.project import PROJECT_SUFFIX

_TO_OPEN = "Scenes and projects (*.glb *.gltf *.obj *.toml)"


class ActionSpec(NamedTuple):
    """An entry of a menu; a `checkable` one is called with whether it is on."""

    name: str
    menu: str
    title: str
    keys: str
    act: Callable[[CommandedWindow, bool], None]
    checkable: bool = False
    group: str = ""


def ask_to_open(window: CommandedWindow) -> None:
    """Let a file be chosen, and open it."""
    path, _ = QFileDialog.getOpenFileName(window, "Open", folder_of(window.session), _TO_OPEN)
    if path:
        window.open_path(path)


def ask_to_save(window: CommandedWindow) -> None:
    """Let a name be chosen, and save the project."""
    path, _ = QFileDialog.getSaveFileName(
        window, "Save project", folder_of(window.session), "Projects (*.toml)"
    )
    if path:
        window.save(path if path.endswith(PROJECT_SUFFIX) else path + PROJECT_SUFFIX)


def ask_to_export(window: CommandedWindow) -> None:
    """Let a name be chosen, and write the picture."""
    path, _ = QFileDialog.getSaveFileName(
        window, "Export picture", folder_of(window.session), "Pictures (*.png *.exr)"
    )
    if path:
        window.export(path)


def _mode(mode: CameraMode) -> Callable[[CommandedWindow, bool], None]:
    return lambda window, on: window.desk.viewport.set_mode(mode)


ACTIONS: list[ActionSpec] = [
    ActionSpec("open", "File", "Open scene or project\N{HORIZONTAL ELLIPSIS}", "Ctrl+O",
               lambda window, on: ask_to_open(window)),
    ActionSpec("save", "File", "Save project\N{HORIZONTAL ELLIPSIS}", "Ctrl+S",
               lambda window, on: ask_to_save(window)),
    ActionSpec("export", "File", "Export picture (PNG, EXR)\N{HORIZONTAL ELLIPSIS}", "Ctrl+E",
               lambda window, on: ask_to_export(window)),
    ActionSpec("screenshot", "File", "Screenshot of the picture", "F12",
               lambda window, on: window.save_screenshot()),
    ActionSpec("quit", "File", "Quit", "Ctrl+Q", lambda window, on: window.close_soon()),
    ActionSpec("undo", "Edit", "Undo", "Ctrl+Z", lambda window, on: window.undo()),
    ActionSpec("redo", "Edit", "Redo", "Ctrl+Shift+Z", lambda window, on: window.redo()),
    ActionSpec("orbit", "Camera", "Turn around the scene", "1", _mode(CameraMode.ORBIT),
               True, "camera"),
    ActionSpec("fly", "Camera", "Fly", "2", _mode(CameraMode.FLY), True, "camera"),
    ActionSpec("space", "Camera", "From the ground to space", "3", _mode(CameraMode.SPACE),
               True, "camera"),
    ActionSpec("frame", "Camera", "See the whole scene", "F",
               lambda window, on: window.desk.viewport.frame_scene()),
    ActionSpec("play", "Time", "Play or pause", "Space",
               lambda window, on: window.time.toggle_play()),
    ActionSpec("now", "Time", "Now", "N", lambda window, on: window.time.go_to_now()),
    ActionSpec("day before", "Time", "A day earlier", "Ctrl+PgUp",
               lambda window, on: window.time.step_days(-1)),
    ActionSpec("day after", "Time", "A day later", "Ctrl+PgDown",
               lambda window, on: window.time.step_days(1)),
    ActionSpec("sun path", "View", "Sun path", "P",
               lambda window, on: window.desk.sun_path.show(on), True),
    ActionSpec("compare", "View", "Compare two skies", "C",
               lambda window, on: window.show_dock("compare")),
    ActionSpec("profiler", "View", "Profiler", "F3",
               lambda window, on: window.profiler.setVisible(on), True),
    ActionSpec("modules", "View", "Module manager", "F4",
               lambda window, on: window.toggle_dock("modules")),
    ActionSpec("messages", "View", "Message inspector", "F5",
               lambda window, on: window.toggle_dock("messages")),
    ActionSpec("palette", "Help", "Find a command…", "Ctrl+K, Ctrl+Shift+P",
               lambda window, on: window.show_palette()),
    ActionSpec("keys", "Help", "Keys", "F1", lambda window, on: window.show_keys()),
]  # fmt: skip

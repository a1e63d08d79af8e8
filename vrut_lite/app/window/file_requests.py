"""File dialogs: open, save, export."""

from typing import TYPE_CHECKING

from PySide6.QtWidgets import QFileDialog

from vrut_lite.app.engine.session_project import folder_of
from vrut_lite.project import PROJECT_SUFFIX

if TYPE_CHECKING:
    from vrut_lite.app.window.main_window import MainWindow

_TO_OPEN = "Scenes and projects (*.glb *.gltf *.obj *.toml)"


def ask_to_open(window: "MainWindow") -> None:
    """Let a file be chosen, and open it."""
    path, _ = QFileDialog.getOpenFileName(window, "Open", folder_of(window.session), _TO_OPEN)
    if path:
        window.open_path(path)


def ask_to_save(window: "MainWindow") -> None:
    """Let a name be chosen, and save the project."""
    path, _ = QFileDialog.getSaveFileName(
        window, "Save project", folder_of(window.session), "Projects (*.toml)"
    )
    if path:
        window.save(path if path.endswith(PROJECT_SUFFIX) else path + PROJECT_SUFFIX)


def ask_to_export(window: "MainWindow") -> None:
    """Let a name be chosen, and write the picture."""
    path, _ = QFileDialog.getSaveFileName(
        window, "Export picture", folder_of(window.session), "Pictures (*.png *.exr)"
    )
    if path:
        window.export(path)

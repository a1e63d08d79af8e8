"""Files that are dropped on the picture."""

from pathlib import Path

from PySide6.QtGui import QDropEvent

from vrut_lite.scene.scene_files import SUFFIXES

_SCENE_SUFFIXES = (*SUFFIXES, ".toml")


def dropped_scene(event: QDropEvent) -> str | None:
    """The first dropped file that is a scene or a project, by its suffix."""
    paths = [url.toLocalFile() for url in event.mimeData().urls()]
    return next((p for p in paths if Path(p).suffix.lower() in _SCENE_SUFFIXES), None)

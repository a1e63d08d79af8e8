"""The window as its commands see it: what actions, menus and palette may ask of it."""

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QDockWidget, QMainWindow

from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.time_panel import TimePanel
from vrut_lite.app.view.profiler_overlay import ProfilerOverlay
from vrut_lite.app.window.desk import Desk
from vrut_lite.app.window.kept import Kept


class CommandedWindow(QMainWindow):
    """Base of `MainWindow`, which makes the parts and does the work."""

    session: Session
    desk: Desk
    kept: Kept
    profiler: ProfilerOverlay
    docks: dict[str, QDockWidget]
    actions_by_name: dict[str, QAction]

    @property
    def time(self) -> TimePanel:
        """The time bar's panel."""
        raise NotImplementedError

    def open_path(self, path: str) -> None:
        """Open a scene or a project; a file that cannot be opened changes nothing."""
        raise NotImplementedError

    def save(self, path: str) -> None:
        """Save the project."""
        raise NotImplementedError

    def export(self, path: str) -> None:
        """Write the picture."""
        raise NotImplementedError

    def save_screenshot(self) -> None:
        """Write the picture as it looks now into the folder `pictures`."""
        raise NotImplementedError

    def undo(self) -> None:
        """Undo the last change."""
        raise NotImplementedError

    def redo(self) -> None:
        """Redo the change that was undone last."""
        raise NotImplementedError

    def show_dock(self, name: str) -> None:
        """Show a dock, as the front tab of its group."""
        raise NotImplementedError

    def toggle_dock(self, name: str) -> None:
        """Hide a dock that is seen; show one that is not."""
        raise NotImplementedError

    def show_palette(self) -> None:
        """Open the command palette."""
        raise NotImplementedError

    def show_keys(self) -> None:
        """Open the list of keys."""
        raise NotImplementedError

    def close_soon(self) -> None:
        """Close, after the event that asked for it."""
        raise NotImplementedError

"""Views that a project keeps by name, and their entries in the camera's menu."""

from collections.abc import Callable
from functools import partial

from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QMenu

from vrut_lite.messages.camera import MoveCamera
from vrut_lite.project import CameraView

# Keys of the first views.
_WITH_KEYS = 9


class Views:
    """The kept views of one window, in the order in which they were kept.

    `go` is called with the camera of a view that was chosen.
    """

    def __init__(self, menu: QMenu, go: Callable[[MoveCamera], None]):
        self._menu, self._go = menu, go
        self.kept: dict[str, CameraView] = {}
        self.show({})

    def show(self, views: dict[str, CameraView]) -> None:
        """Take over the views of a project."""
        self.kept = dict(views)
        self._menu.clear()
        for number, (name, view) in enumerate(self.kept.items(), 1):
            title = name.replace("&", "&&")
            action = self._menu.addAction(title, partial(self._go, view.camera()))
            if number <= _WITH_KEYS:
                action.setShortcut(QKeySequence(f"Ctrl+{number}"))
        if not self.kept:
            self._menu.addAction("none is kept").setEnabled(False)
            return
        self._menu.addSeparator()
        forget = self._menu.addMenu("Forget")
        for name in self.kept:
            forget.addAction(name.replace("&", "&&"), partial(self.forget, name))

    def keep(self, name: str, view: CameraView) -> None:
        """Keep a view; one of the same name is replaced."""
        self.show({**self.kept, name: view})

    def forget(self, name: str) -> None:
        """Drop a view."""
        self.show({other: view for other, view in self.kept.items() if other != name})

    @property
    def next_name(self) -> str:
        """A name that none has yet."""
        number = next(n for n in range(1, len(self.kept) + 2) if f"View {n}" not in self.kept)
        return f"View {number}"

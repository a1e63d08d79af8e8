"""The entries of the command palette: actions, panels, settings, skies and recent files."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QScrollArea, QWidget

from vrut_lite.app.panels.module_panel import ModulePanel
from vrut_lite.app.panels.setting_row import label_of
from vrut_lite.kernel.messages import ChooseSlot

if TYPE_CHECKING:
    from vrut_lite.app.window.main_window import MainWindow


class PaletteEntry(NamedTuple):
    """A title, a hint beside it (its key for example), and the command."""

    title: str
    hint: str
    act: Callable[[], None]


def entries_of(window: "MainWindow") -> list[PaletteEntry]:
    """The present entries, the most general first."""
    return [
        *_actions(window),
        *_docks(window),
        *_slots(window),
        *_settings(window),
        *_recent(window),
    ]


def matching(entries: list[PaletteEntry], text: str) -> list[PaletteEntry]:
    """Those that hold all words of a text; titles that begin with the first come first."""
    words = text.lower().split()
    found = [
        entry
        for entry in entries
        if all(word in f"{entry.title} {entry.hint}".lower() for word in words)
    ]
    return sorted(found, key=lambda entry: _rank(entry.title.lower(), words))


def _rank(title: str, words: list[str]) -> int:
    if not words or title.startswith(words[0]):
        return 0
    return 1 if any(part.startswith(words[0]) for part in title.split()) else 2


def _actions(window: "MainWindow") -> Iterator[PaletteEntry]:
    for action in window.actions_by_name.values():
        if action.isEnabled():
            title = action.text().removesuffix("\N{HORIZONTAL ELLIPSIS}")
            keys = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
            yield PaletteEntry(title, keys, action.trigger)


def _docks(window: "MainWindow") -> Iterator[PaletteEntry]:
    for name, dock in window.docks.items():
        yield PaletteEntry(f"{dock.windowTitle()} panel", "panel", partial(window.show_dock, name))


def _slots(window: "MainWindow") -> Iterator[PaletteEntry]:
    roster = window.session.roster
    for slot in roster.slots:
        for module in roster.providers(slot):
            choice = ChooseSlot(slot=slot, module=module.name)
            yield PaletteEntry(
                f"{slot.capitalize()} by {module.title}",
                f"slot {slot}",
                partial(window.session.send, choice),
            )


def _settings(window: "MainWindow") -> Iterator[PaletteEntry]:
    for name, dock in window.docks.items():
        for panel in dock.findChildren(ModulePanel):
            # Of the skies' panels only that of the slot's holder is shown.
            if panel.isHidden():
                continue
            for row in panel.rows.values():
                act = partial(_go_to, window, name, row.editor)
                yield PaletteEntry(label_of(row.spec), panel.title, act)


def _go_to(window: "MainWindow", dock: str, control: QWidget) -> None:
    window.show_dock(dock)
    control.setFocus()
    area = window.docks[dock].widget()
    if isinstance(area, QScrollArea):
        area.ensureWidgetVisible(control)


def _recent(window: "MainWindow") -> Iterator[PaletteEntry]:
    for path in window.kept.recent:
        yield PaletteEntry(f"Open {Path(path).name}", path, partial(window.open_path, path))

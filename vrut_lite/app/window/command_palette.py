"""The command palette: every action by a few letters of its name."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import NamedTuple

from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtGui import QAction, QColor, QKeyEvent, QKeySequence
from PySide6.QtWidgets import (
    QDialog,
    QDockWidget,
    QHeaderView,
    QLineEdit,
    QScrollArea,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from vrut_lite.app import theme
from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.module_panel import ModulePanel
from vrut_lite.app.setting_words import choice_label, label_of
from vrut_lite.kernel.messages import ChooseSlot, SetSetting

_WIDTH_PX, _HEIGHT_PX, _TOP_PX = 520, 380, 70
_MOVING = (Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_PageUp, Qt.Key.Key_PageDown)


class PaletteEntry(NamedTuple):
    """A title, a hint beside it (its key for example), the command, and its tooltip.

    A tooltip's words are found too: a module's name, for those who know it from scripts.
    """

    title: str
    hint: str
    act: Callable[[], None]
    tip: str = ""


class CommandPalette(QDialog):
    """A text field above the matching commands; arrows move, Enter runs one, Escape closes."""

    def __init__(self, window: QWidget, entries: list[PaletteEntry]):
        super().__init__(window, Qt.WindowType.Popup)
        self._window = window
        self._entries = self.found = entries
        self.text_field = QLineEdit()
        self.text_field.setPlaceholderText("Find a command")
        self.text_field.setAccessibleName("command")
        self.list = QTreeWidget()
        self.list.setAccessibleName("commands")
        self.list.setHeaderHidden(True)
        self.list.setRootIsDecorated(False)
        self.list.setUniformRowHeights(True)
        self.list.setColumnCount(2)
        self.list.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        header = self.list.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(1, QHeaderView.ResizeMode.ResizeToContents)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        column = QVBoxLayout(self)
        column.addWidget(self.text_field)
        column.addWidget(self.list)
        self.setStyleSheet(f"QDialog {{ border: 1px solid {theme.LINE}; }}")
        self.text_field.installEventFilter(self)
        self.text_field.textChanged.connect(self._search)
        self.text_field.returnPressed.connect(self._run)
        self.list.itemClicked.connect(lambda *_: self._run())
        self._search("")
        self._place()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Arrows move through the list while the text field has the focus."""
        if (
            event.type() == QEvent.Type.KeyPress
            and isinstance(event, QKeyEvent)
            and event.key() in _MOVING
        ):
            self.list.keyPressEvent(event)
            return True
        return False

    def _place(self) -> None:
        corner = self._window.mapToGlobal(self._window.rect().topLeft())
        self.resize(min(_WIDTH_PX, self._window.width() - 40), _HEIGHT_PX)
        self.move(corner.x() + (self._window.width() - self.width()) // 2, corner.y() + _TOP_PX)

    def _search(self, text: str) -> None:
        self.found = matching(self._entries, text)
        self.list.clear()
        for entry in self.found:
            item = QTreeWidgetItem(self.list, [entry.title, entry.hint])
            item.setForeground(1, QColor(theme.FAINT))
            item.setToolTip(0, entry.tip)
        self.list.setCurrentIndex(self.list.model().index(0, 0))

    def _run(self) -> None:
        place = self.list.currentIndex().row()
        self.accept()
        if 0 <= place < len(self.found):
            # The command may open another dialog, so this one is closed first.
            QTimer.singleShot(0, self._window, self.found[place].act)


def matching(entries: list[PaletteEntry], text: str) -> list[PaletteEntry]:
    """Entries with all words of a text; titles that begin with the first word come first."""
    words = text.lower().split()
    found = [
        entry
        for entry in entries
        if all(word in f"{entry.title} {entry.hint} {entry.tip}".lower() for word in words)
    ]
    return sorted(found, key=lambda entry: _rank(entry.title.lower(), words))


def _rank(title: str, words: list[str]) -> int:
    if not words or title.startswith(words[0]):
        return 0
    return 1 if any(part.startswith(words[0]) for part in title.split()) else 2


def action_entries(actions: Iterable[QAction]) -> Iterator[PaletteEntry]:
    """The enabled actions, with their keys."""
    for action in actions:
        if action.isEnabled():
            title = action.text().replace("&", "").removesuffix("\N{HORIZONTAL ELLIPSIS}")
            keys = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
            yield PaletteEntry(title, keys, action.trigger)


def dock_entries(
    docks: Mapping[str, QDockWidget], show_dock: Callable[[str], None]
) -> Iterator[PaletteEntry]:
    """Each dock, then each setting in a dock."""
    for name, dock in docks.items():
        yield PaletteEntry(f"{dock.windowTitle()} panel", "panel", partial(show_dock, name))
    for name, dock in docks.items():
        for panel in dock.findChildren(ModulePanel):
            # Only the sky panel of the slot's holder is shown.
            if panel.isHidden():
                continue
            for row in panel.rows.values():
                act = partial(_go_to, dock, row.editor, partial(show_dock, name))
                yield PaletteEntry(label_of(row.spec), panel.title, act, row.spec.name)


def slot_entries(session: Session) -> Iterator[PaletteEntry]:
    """Each module that can hold a slot."""
    catalogue = session.catalogue
    for slot in catalogue.slots:
        for module in catalogue.providers(slot):
            choice = ChooseSlot(slot=slot, module=module.name)
            title = f"{slot.replace('_', ' ').capitalize()}: {module.title}"
            yield PaletteEntry(title, "", partial(session.send, choice), module.name)


def choice_entries(session: Session) -> Iterator[PaletteEntry]:
    """Each choice of a setting whose author gave it a name: a genus of clouds, a kind of sky."""
    for module in session.catalogue.modules.values():
        for name, spec in module.specs.items():
            for choice in spec.choices if spec.choice_labels else ():
                act = partial(session.send, SetSetting(module=module.name, name=name, value=choice))
                hint = f"{module.title}, {label_of(spec)}"
                yield PaletteEntry(choice_label(spec, choice), hint, act)


def recent_entries(
    paths: Iterable[str], open_path: Callable[[str], None]
) -> Iterator[PaletteEntry]:
    """The files that were opened before."""
    for path in paths:
        yield PaletteEntry(f"Open {Path(path).name}", path, partial(open_path, path))


def _go_to(dock: QDockWidget, control: QWidget, show: Callable[[], None]) -> None:
    show()
    control.setFocus()
    area = dock.widget()
    if isinstance(area, QScrollArea):
        area.ensureWidgetVisible(control)

"""The module manager: states, last faults, enable, restart, reload, safe mode."""

import re

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QFontDatabase
from PySide6.QtWidgets import (
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPlainTextEdit,
    QPushButton,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from vrut_lite.app import theme
from vrut_lite.app.engine.module_states import ModuleState, ModuleStates, into_safe_mode, states_of
from vrut_lite.app.engine.session import Session, fault_line, one_line
from vrut_lite.app.panels.package_bar import PackageBar
from vrut_lite.app.widgets import faint_label, heading, panel_column
from vrut_lite.kernel.messages import (
    EnableModule,
    Fault,
    ReloadModule,
    RestartModule,
    SlotChanged,
)
from vrut_lite.package_facts import PackageFacts, packages_of_others

_NOT_LOADED = "not loaded"
_NAME = Qt.ItemDataRole.UserRole
_COLOURS = {"running": theme.TEXT, "disabled": theme.FAINT, "suspended": theme.ALARM}
_TELLING = (Fault, EnableModule, RestartModule, ReloadModule, SlotChanged)


class ModuleManager(QWidget):
    """A row for each module, those that could not be loaded too; below, all about the chosen one.

    Its package, what it posts and hears, its last fault, and the actions; last, what installs and
    removes packages of somebody else.
    """

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self._states = ModuleStates({}, ())
        # Modules whose boxes were ticked or not, until the states agree: the engine may be busy.
        self._asked: dict[str, bool] = {}
        self._asking = False
        self._before_safe_mode: set[str] = set()
        self._packages: dict[str, PackageFacts] | None = None
        # The last fault of each module before it was restarted or reloaded.
        self._before_restart: dict[str, Fault | None] = {}
        self._make_parts()
        self._lay_out()
        self.list.itemChanged.connect(self._checked)
        self.list.currentItemChanged.connect(lambda *_: self._choose())
        self.restart.clicked.connect(lambda: self._session.send(RestartModule(module=self.chosen)))
        self.reload.clicked.connect(lambda: self._session.send(ReloadModule(module=self.chosen)))
        self.safe_mode.clicked.connect(self.set_safe_mode)
        session.ready.connect(lambda _: self._ask())
        session.listen(RestartModule, lambda message: self._note_restart(message.module))
        session.listen(ReloadModule, lambda message: self._note_restart(message.module))
        for kind in _TELLING:
            session.listen(kind, lambda _: self._ask())

    @property
    def chosen(self) -> str:
        """Name of the module in the chosen row."""
        item = self.list.currentItem()
        return "" if item is None else str(item.data(0, _NAME))

    @property
    def switched_off(self) -> set[str] | None:
        """Names of the modules that are off; None in safe mode, which ends with the window."""
        if self._states.safe:
            return None
        modules = self._states.modules.values()
        return {m.name for m in modules if not self._asked.get(m.name, m.state != "disabled")}

    def choose(self, name: str) -> None:
        """Go to the row of a module."""
        item = self._item(name)
        if item is not None:
            self.list.setCurrentItem(item)

    def set_safe_mode(self, on: bool) -> None:
        """Switch off all but the host and the default sun and sky, or switch them on again."""
        running = {m.name for m in self._states.modules.values() if m.state == "running"}
        if on:
            self._before_safe_mode = running
            self._session.send(*into_safe_mode(self._states))
        else:
            wanted = self._before_safe_mode or set(self._states.modules)
            self._session.send(*(EnableModule(module=name) for name in sorted(wanted - running)))
        self._show_states(self._states)

    # --- widgets -----------------------------------------------------------------------------

    def _make_parts(self) -> None:
        self.safe_mode = QPushButton("Safe mode")
        self.safe_mode.setCheckable(True)
        self.safe_mode.setToolTip("Run only the host and the default sun and sky")
        self.list = QTreeWidget()
        self.list.setAccessibleName("modules")
        self.list.setHeaderLabels(["Module", "State", "Holds", "Version"])
        self.list.setRootIsDecorated(False)
        self.list.setUniformRowHeights(True)
        header = self.list.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.title = heading("Opening the modules\N{HORIZONTAL ELLIPSIS}")
        self.restart = QPushButton("Restart")
        self.restart.setToolTip("Start the module anew with its present settings")
        self.reload = QPushButton("Reload")
        self.reload.setToolTip("Import the module's files afresh; its settings stay")
        self.facts = faint_label(wraps=True)
        self.facts.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.packages = PackageBar()
        self.status = QLabel()
        self.status.setWordWrap(True)
        self.status.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.trace = QPlainTextEdit()
        self.trace.setReadOnly(True)
        self.trace.setAccessibleName("trace of the last fault")
        self.trace.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.trace.setLineWrapMode(QPlainTextEdit.LineWrapMode.NoWrap)
        self.failures = QLabel()
        self.failures.setWordWrap(True)
        self.failures.setStyleSheet(f"color: {theme.ALARM};")

    def _lay_out(self) -> None:
        top, middle = QHBoxLayout(), QHBoxLayout()
        top.addStretch(1)
        top.addWidget(self.safe_mode)
        middle.addWidget(self.title, 1)
        middle.addWidget(self.restart)
        middle.addWidget(self.reload)
        column = panel_column(self)
        column.addLayout(top)
        column.addWidget(self.list, 3)
        column.addLayout(middle)
        column.addWidget(self.facts)
        column.addWidget(self.status)
        column.addWidget(self.trace, 2)
        column.addWidget(self.failures)
        column.addWidget(self.packages)

    # --- messages ----------------------------------------------------------------------------

    def _note_restart(self, name: str) -> None:
        module = self._states.modules.get(name)
        if module is not None:
            self._before_restart[module.name] = module.fault

    def _ask(self) -> None:
        """Ask for the states, once for all messages that came until the answer."""
        if not self._asking:
            self._asking = True
            self._session.ask(states_of, self._take)

    def _take(self, states: ModuleStates) -> None:
        self._asking = False
        self._show_states(states)

    def _show_states(self, states: ModuleStates) -> None:
        self._states = states
        for module in states.modules.values():
            if self._asked.get(module.name) == (module.state != "disabled"):
                del self._asked[module.name]
        self.list.blockSignals(True)
        for module in states.modules.values():
            self._show_row(self._item(module.name) or self._new_item(module), module)
        for name, package in self._not_loaded().items():
            self._show_missing(name, package)
        self.list.blockSignals(False)
        if self.list.currentItem() is None:
            self.choose(next(iter(states.modules), ""))
        self.safe_mode.setChecked(states.safe)
        self._show_chosen()

    def _not_loaded(self) -> dict[str, PackageFacts]:
        """Packages of somebody else, as this process found them, by names of missing modules."""
        if self._packages is None:
            self._packages = packages_of_others()
        loaded = self._states.modules
        return {name: facts for name, facts in self._packages.items() if name not in loaded}

    def _show_missing(self, name: str, package: PackageFacts) -> None:
        item = self._item(name) or QTreeWidgetItem(self.list)
        item.setData(0, _NAME, name)
        item.setFlags(Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable)
        for column, text in enumerate((name, _NOT_LOADED, "", package.version)):
            item.setText(column, text)
        item.setForeground(1, QColor(theme.ALARM))

    def _new_item(self, module: ModuleState) -> QTreeWidgetItem:
        item = QTreeWidgetItem(self.list)
        item.setData(0, _NAME, module.name)
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        item.setFlags(flags if module.of_host else flags | Qt.ItemFlag.ItemIsUserCheckable)
        return item

    def _show_row(self, item: QTreeWidgetItem, module: ModuleState) -> None:
        item.setText(0, module.title)
        item.setToolTip(0, f"{module.name}, a part of the host" if module.of_host else module.name)
        if not module.of_host:
            running = module.state == "running"
            item.setCheckState(0, Qt.CheckState.Checked if running else Qt.CheckState.Unchecked)
        item.setText(1, module.state)
        item.setForeground(1, QColor(_COLOURS.get(module.state, theme.TEXT)))
        item.setText(2, ", ".join(module.holds).replace("_", " "))
        item.setText(3, module.version)

    def _item(self, name: str) -> QTreeWidgetItem | None:
        items = (self.list.topLevelItem(row) for row in range(self.list.topLevelItemCount()))
        return next((item for item in items if item and item.data(0, _NAME) == name), None)

    def _choose(self) -> None:
        self._show_chosen()
        # Types posted since the last look.
        self._ask()

    def _show_chosen(self) -> None:
        module = self._states.modules.get(self.chosen)
        others = [line for line in self._states.failures if line != self._why_missing]
        self.failures.setText("\n".join(others))
        self.failures.setVisible(bool(others))
        package = (self._packages or {}).get(self.chosen)
        self.packages.choose(package)
        self.facts.setText(facts_text(module, package))
        self.facts.setToolTip(names_text(module))
        for button in (self.restart, self.reload):
            button.setEnabled(module is not None)
        if module is None:
            self.title.setText(self.chosen)
            self.status.setText(self._why_missing)
            self.status.setStyleSheet(f"color: {theme.ALARM};")
            self.trace.setVisible(False)
            return
        self.reload.setEnabled(not module.of_host)
        self.title.setText(module.title)
        fault = module.fault
        mended = fault is not None and fault is self._before_restart.get(module.name)
        self.status.setText(status_line(fault, mended, module.title))
        alarming = fault is not None and not mended
        self.status.setStyleSheet(f"color: {theme.ALARM if alarming else theme.FAINT};")
        self.trace.setVisible(fault is not None)
        trace = "" if fault is None else fault.trace
        if trace != self.trace.toPlainText():
            self.trace.setPlainText(trace)

    @property
    def _why_missing(self) -> str:
        """The sentence on the chosen module if it is not loaded; empty if it is."""
        name = self.chosen
        if not name or name in self._states.modules:
            return ""
        told = (line for line in self._states.failures if line.startswith(f"module '{name}' "))
        return next(told, "Left out by safe mode.")

    # --- inputs ------------------------------------------------------------------------------

    def _checked(self, item: QTreeWidgetItem) -> None:
        name, wanted = str(item.data(0, _NAME)), item.checkState(0) == Qt.CheckState.Checked
        self._asked[name] = wanted
        self._session.send(EnableModule(module=name, enabled=wanted))


def facts_text(module: ModuleState | None, package: PackageFacts | None) -> str:
    """The lines on a module's package, and on what it posts and hears."""
    lines = []
    if package is not None:
        lines.append(f"Package: {package.title}")
    if module is not None:
        posts, hears = (", ".join(map(_in_words, names)) for names in (module.posts, module.hears))
        lines.append(f"Posts: {posts or 'nothing so far'}")
        lines.append(f"Hears: {hears or 'nothing'}")
    return "\n".join(lines)


def names_text(module: ModuleState | None) -> str:
    """The same by the names of the message types, for authors of modules."""
    if module is None:
        return ""
    return f"Posts: {', '.join(module.posts)}\nHears: {', '.join(module.hears)}"


def _in_words(type_name: str) -> str:
    """A message type in words: "sun moved"."""
    return re.sub("(?<=[a-z0-9])(?=[A-Z])", " ", type_name).lower()


def status_line(fault: Fault | None, mended: bool, title: str) -> str:
    """The line on a module's last fault, which is past if the module was restarted since."""
    if fault is None:
        return "No fault so far."
    if mended:
        return f"No fault since it was restarted. Before: {one_line(fault.error)}"
    return fault_line(fault, title)

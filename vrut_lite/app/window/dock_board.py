"""The docks around the picture: made, shown, hidden, and arranged."""

from functools import partial

from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow, QTabWidget, QWidget

from vrut_lite.app.engine.module_catalogue import ModuleCatalogue
from vrut_lite.app.widgets import make_timer
from vrut_lite.app.window.actions import ActionSpec
from vrut_lite.app.window.dock_title import DockTitle
from vrut_lite.app.window.docks import DOCKS, GROUPS, DockSpec, module_docks, scrolled
from vrut_lite.app.window.keys import KeyJudge
from vrut_lite.app.window.menus import Menus
from vrut_lite.app.window.panel_context import PanelContext
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import pass_interrupt

# The widest that docks are at first, in pixels and as a share of the window: pictures are to be
# seen in those of the tools.
_RIGHT, _TOOLS = (420, 0.3), (560, 0.35)
_TIME = "time"


class DockBoard:
    """The `docks` of a window, and the `panels` in them, by name; menus show them too."""

    def __init__(self, window: QMainWindow, desk: PanelContext, menus: Menus):
        self._window, self._desk, self._menus = window, desk, menus
        self.docks: dict[str, QDockWidget] = {}
        self.panels: dict[str, QWidget] = {}
        self._titles: dict[str, DockTitle] = {}
        self._keys = KeyJudge(window)
        self._names_changed = make_timer(window, 0, self._show_names, once=True)
        window.setDockNestingEnabled(True)
        window.setTabPosition(Qt.DockWidgetArea.AllDockWidgetAreas, QTabWidget.TabPosition.North)
        for spec in DOCKS:
            self.add(spec)
        self._arrange()

    def add_modules(self, catalogue: ModuleCatalogue) -> list[str]:
        """Make the docks of the modules; a sentence for each that failed."""
        docks, failures = module_docks(catalogue)
        for spec in docks:
            try:
                self.add(spec)
            # A module's own panel may raise anything.
            except BaseException as error:
                pass_interrupt(error)
                failures.append(f"the {spec.name} failed: {sentence_of(error)}")
        for panel in self.panels.values():
            self._keys.watch(panel)
        self._arrange()
        return failures

    def show(self, name: str) -> None:
        """Show a dock, as the front tab of its group."""
        self.docks[name].show()
        self.docks[name].raise_()

    def go_to(self, name: str) -> None:
        """Show a dock, and give the keys to its first control."""
        self.show(name)
        panel = self.panels[name]
        controls = [
            control
            for control in panel.findChildren(QWidget)
            if control.focusPolicy() & Qt.FocusPolicy.TabFocus
            and control.isVisible()
            and control.isEnabled()
        ]
        if controls:
            highest = min(controls, key=lambda control: control.mapTo(panel, QPoint()).y())
            highest.setFocus(Qt.FocusReason.TabFocusReason)

    def toggle(self, name: str) -> None:
        """Hide a visible dock; show a hidden one."""
        if self.panels[name].visibleRegion().isEmpty():
            self.show(name)
        else:
            self.docks[name].hide()

    def add(self, spec: DockSpec) -> None:
        """Make a dock; it joins the tabs of its group."""
        panel = spec.make(self._desk)
        self._keys.watch(panel)
        dock = QDockWidget(spec.title, self._window)
        dock.setObjectName(spec.name)
        dock.setWidget(scrolled(panel) if spec.scrolled else panel)
        beside = spec.group == _TIME
        if beside:
            # A bar above would take the picture's height.
            dock.setFeatures(
                dock.features() | QDockWidget.DockWidgetFeature.DockWidgetVerticalTitleBar
            )
        self._titles[spec.name] = DockTitle(dock, beside, spec.advanced)
        dock.setTitleBarWidget(self._titles[spec.name])
        dock.visibilityChanged.connect(lambda _: self._names_changed.start())
        dock.dockLocationChanged.connect(lambda _: self._names_changed.start())
        group = [dock for dock in self.docks.values() if dock.property("group") == spec.group]
        dock.setProperty("group", spec.group)
        self._window.addDockWidget(GROUPS[spec.group], dock)
        if group:
            self._window.tabifyDockWidget(group[-1], dock)
        dock.setVisible(spec.shown)
        self.docks[spec.name], self.panels[spec.name] = dock, panel
        if not spec.advanced:
            self._menus.panels.addAction(dock.toggleViewAction())
        if spec.file_entry:
            self._menus.add(
                ActionSpec(spec.name, "File", spec.file_entry, "", partial(self._ask, spec.name)),
                before="quit",
            )
        if spec.keys:
            self._menus.add(
                ActionSpec(spec.name, "View", spec.title, spec.keys,
                           partial(self.toggle, spec.name), advanced=spec.advanced)
            )  # fmt: skip

    def _ask(self, name: str) -> None:
        self.show(name)
        self.panels[name].ask_for_file()  # type: ignore[attr-defined]

    def _show_names(self) -> None:
        """A dock alone in its place has no tab to show its name."""
        for name, dock in self.docks.items():
            beside = self._window.tabifiedDockWidgets(dock)
            self._titles[name].show_name(all(other.isHidden() for other in beside))

    def _arrange(self) -> None:
        docks = [dock for dock in self.docks.values() if dock.property("group") != _TIME]
        widths_px = [
            self._first_width_px(*(_TOOLS if dock.property("group") == "tools" else _RIGHT))
            for dock in docks
        ]
        self._window.resizeDocks(docks, widths_px, Qt.Orientation.Horizontal)
        self._window.resizeDocks(
            [self.docks["place"], self.docks["sky"]], [430, 440], Qt.Orientation.Vertical
        )
        self.docks["place"].raise_()
        self.docks["sky"].raise_()

    def _first_width_px(self, most_px: int, share: float) -> int:
        # A window that is not shown yet has no width.
        is_visible = self._window.isVisible()
        return min(most_px, round(share * self._window.width())) if is_visible else most_px

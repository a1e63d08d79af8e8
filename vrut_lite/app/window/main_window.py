"""The window: the picture, the docks around it, the menus, and the status line."""

from functools import partial
from pathlib import Path

from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import (
    QDockWidget,
    QLabel,
    QMainWindow,
    QTabWidget,
    QWidget,
)

from vrut_lite.app.engine.day_scout import DayScout
from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.roster import Roster
from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.picture_panel import PicturePanel
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.panels.time_panel import TimePanel
from vrut_lite.app.view.compass import Compass
from vrut_lite.app.view.profiler_overlay import ProfilerOverlay
from vrut_lite.app.view.sun_path import SunPath
from vrut_lite.app.view.viewport import CameraMode, Viewport
from vrut_lite.app.widgets import make_timer
from vrut_lite.app.window.actions import ActionSpec, action_specs
from vrut_lite.app.window.command_palette import (
    CommandPalette,
    action_entries,
    dock_entries,
    recent_entries,
    slot_entries,
)
from vrut_lite.app.window.desk import Desk
from vrut_lite.app.window.dock_title import DockTitle
from vrut_lite.app.window.docks import DOCKS, GROUPS, DockSpec, module_docks, scrolled
from vrut_lite.app.window.files import Files
from vrut_lite.app.window.kept import Kept, WindowShape
from vrut_lite.app.window.keys import KeyJudge
from vrut_lite.app.window.menus import Menus
from vrut_lite.app.window.shortcut_list import ShortcutList
from vrut_lite.app.window.status_line import StatusLine
from vrut_lite.app.window.views import Views
from vrut_lite.daylight.picture import SetExposure
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.scene import LoadScene, SceneOpened
from vrut_lite.daylight.sun import SunMoved
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel.messages import SettingChanged

TITLE = "vrut_lite"
_RIGHT_PX, _MOST_RIGHT = 420, 0.3


class MainWindow(QMainWindow):
    """The window of one session; closing it closes the session."""

    def __init__(
        self, session: Session, presets: PresetStore | None = None, kept: Kept | None = None
    ):
        super().__init__()
        self.setWindowTitle(TITLE)
        self.session = session
        sun_path, compass = SunPath(self), Compass(self)
        self.desk: Desk = Desk(
            session=session,
            scout=DayScout(session, self),
            sun_path=sun_path,
            compass=compass,
            viewport=Viewport(session, sun_path, compass),
            presets=presets or PresetStore(),
        )
        self.docks: dict[str, QDockWidget] = {}
        self.titles: dict[str, DockTitle] = {}
        self._names_changed = make_timer(self, 0, self._show_names, once=True)
        self.panels: dict[str, QWidget] = {}
        self._keys = KeyJudge(self)
        self.setCentralWidget(self.desk.viewport)
        self.profiler: ProfilerOverlay = ProfilerOverlay(session, self.desk.viewport)
        self._status = StatusLine()
        self._opened: LoadScene | None = None
        self.setStatusBar(self._status)
        self.files = Files(self.desk, kept or Kept(None), self._status, self._show_title)
        self.menus = Menus(
            self,
            action_specs(self, self.desk, self.files, self.profiler),
            lambda: self.files.kept.recent,
            self.files.open_path,
        )
        self.actions_by_name = self.menus.actions
        self.files.views = Views(self.menus.views, self.desk.viewport.go_to)
        for spec in DOCKS:
            self.add_dock(spec)
        self._arrange()
        self._connect()

    @property
    def time(self) -> TimePanel:
        """The time bar's panel."""
        panel = self.panels["time"]
        assert isinstance(panel, TimePanel)
        return panel

    @property
    def picture(self) -> PicturePanel:
        """The panel of exposure and tone map."""
        panel = self.panels["picture"]
        assert isinstance(panel, PicturePanel)
        return panel

    @property
    def news(self) -> QLabel:
        """The status line's message."""
        return self._status.news

    # --- widgets -----------------------------------------------------------------------------

    def add_dock(self, spec: DockSpec) -> None:
        """Make a dock; it joins the tabs of its group."""
        panel = spec.make(self.desk)
        self._keys.watch(panel)
        dock = QDockWidget(spec.title, self)
        dock.setObjectName(spec.name)
        dock.setWidget(scrolled(panel) if spec.scrolled else panel)
        beside = spec.group == "time"
        if beside:
            # A bar above would take the picture's height.
            dock.setFeatures(
                dock.features() | QDockWidget.DockWidgetFeature.DockWidgetVerticalTitleBar
            )
        self.titles[spec.name] = DockTitle(dock, beside)
        dock.setTitleBarWidget(self.titles[spec.name])
        dock.visibilityChanged.connect(lambda _: self._names_changed.start())
        dock.dockLocationChanged.connect(lambda _: self._names_changed.start())
        group = [dock for dock in self.docks.values() if dock.property("group") == spec.group]
        dock.setProperty("group", spec.group)
        self.addDockWidget(GROUPS[spec.group], dock)
        if group:
            self.tabifyDockWidget(group[-1], dock)
        dock.setVisible(spec.shown)
        self.docks[spec.name], self.panels[spec.name] = dock, panel
        self.menus.panels.addAction(dock.toggleViewAction())
        if spec.keys:
            self.menus.add(
                ActionSpec(spec.name, "View", spec.title, spec.keys,
                           partial(self.toggle_dock, spec.name))
            )  # fmt: skip

    def _show_names(self) -> None:
        """A dock alone in its place has no tab to show its name."""
        for name, dock in self.docks.items():
            beside = self.tabifiedDockWidgets(dock)
            self.titles[name].show_name(all(other.isHidden() for other in beside))

    def _arrange(self) -> None:
        self.setDockNestingEnabled(True)
        self.setTabPosition(Qt.DockWidgetArea.AllDockWidgetAreas, _TABS_ABOVE)
        right = [dock for dock in self.docks.values() if dock.property("group") != "time"]
        # Before it is shown a window has no width of its own yet.
        most_px = round(_MOST_RIGHT * self.width()) if self.isVisible() else _RIGHT_PX
        width_px = min(_RIGHT_PX, most_px)
        self.resizeDocks(right, [width_px] * len(right), Qt.Orientation.Horizontal)
        self.resizeDocks(
            [self.docks["place"], self.docks["sky"]], [430, 440], Qt.Orientation.Vertical
        )
        self.docks["place"].raise_()
        self.docks["sky"].raise_()

    def _connect(self) -> None:
        session, desk = self.session, self.desk
        desk.scout.day_changed.connect(desk.sun_path.set_day)
        session.listen(SunMoved, desk.sun_path.set_sun)
        session.listen(SettingChanged, self.menus.show_section)
        session.listen(SettingChanged, self.menus.show_values)
        session.listen(SetPlace, desk.sun_path.set_place)
        session.listen(SetPlace, desk.compass.set_place)
        session.listen(SceneOpened, self._scene_loaded)
        session.listen(SetExposure, self.menus.show_exposure)
        session.ready.connect(self._ready)
        session.problem.connect(self._status.show_problem)
        session.picture_shown.connect(self._show_facts)
        session.steps_changed.connect(self.menus.show_steps)
        desk.viewport.scene_dropped.connect(self.files.open_path)
        desk.viewport.mode_changed.connect(self._mode_changed)

    # --- actions -----------------------------------------------------------------------------

    def show_dock(self, name: str) -> None:
        """Show a dock, as the front tab of its group."""
        self.docks[name].show()
        self.docks[name].raise_()

    def go_to_dock(self, name: str) -> None:
        """Show a dock, and give the keys to its first control."""
        self.show_dock(name)
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

    def type_hour(self) -> None:
        """Give the keys to the field of the hour."""
        self.show_dock("time")
        self.time.clock.setFocus(Qt.FocusReason.TabFocusReason)

    def toggle_dock(self, name: str) -> None:
        """Hide a visible dock; show a hidden one."""
        if self.panels[name].visibleRegion().isEmpty():
            self.show_dock(name)
        else:
            self.docks[name].hide()

    def show_palette(self) -> None:
        """Open the command palette."""
        palette = self.new_palette()
        palette.show()
        palette.text_field.setFocus()

    def new_palette(self) -> CommandPalette:
        """A palette of the present commands, the most general first."""
        entries = [
            *action_entries(self.actions_by_name.values()),
            *slot_entries(self.session),
            *dock_entries(self.docks, self.go_to_dock),
            *recent_entries(self.files.kept.recent, self.files.open_path),
        ]
        return CommandPalette(self, entries)

    def show_keys(self) -> None:
        """Open the list of keys."""
        ShortcutList(self.menus.specs, self).show()

    def undo(self) -> None:
        """Undo the last change."""
        self.session.undo(
            lambda title: self._status.show_news(f"Taken back: {title}" if title else "")
        )

    def redo(self) -> None:
        """Redo the change that was undone last."""
        self.session.redo(
            lambda title: self._status.show_news(f"Done again: {title}" if title else "")
        )

    # --- messages ----------------------------------------------------------------------------

    def _ready(self, roster: Roster) -> None:
        docks, failures = module_docks(roster)
        for spec in docks:
            try:
                self.add_dock(spec)
            # A module's own panel may raise anything.
            except BaseException as error:
                pass_interrupt(error)
                failures.append(f"the {spec.name} failed: {sentence_of(error)}")
        for failure in failures:
            self.session.problem.emit(failure)
        for panel in self.panels.values():
            self._keys.watch(panel)
        self._arrange()
        shape = self.files.kept.shape()
        if shape is not None:
            self.restoreGeometry(shape.geometry)
            self.restoreState(shape.docks)

    def _scene_loaded(self, scene: SceneOpened) -> None:
        self._show_title()
        news = f"{Path(scene.path).name}: {scene.triangles:,} triangles"
        # An animated scene is opened anew in each pose.
        if scene.opened is None or scene.opened != self._opened:
            self._status.show_notices(news, scene.notices)
            self.files.add_recent(scene.path)
        self._opened = scene.opened

    def _show_title(self) -> None:
        """The project, the scene, the application, as far as there are such."""
        scene = self.session.last(SceneOpened)
        files = [self.files.project, Path(scene.path) if scene is not None else None]
        names = [file.name for file in files if file is not None]
        self.setWindowTitle(" \N{EN DASH} ".join([*names, TITLE]))

    def _mode_changed(self, mode: CameraMode) -> None:
        self.actions_by_name[mode.name.lower()].setChecked(True)
        self._status.show_news(mode.value)

    def _show_facts(self, shown: Shown) -> None:
        self._status.show_facts(shown, self.session.roster.renderer)

    # --- the end -----------------------------------------------------------------------------

    def close_soon(self) -> None:
        """Close, after the event that asked for it."""
        QTimer.singleShot(0, self.close)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Hide at once; threads that still run end without a window."""
        if not self.session.has_ended:
            self._keep()
            self.time.player.pause()
            self.session.close()
        self.hide()
        event.accept()

    def _keep(self) -> None:
        """Keep the project and the window's layout for the next start, if the host was opened."""
        if not self.session.roster.modules:
            return
        geometry, docks = self.saveGeometry().data(), self.saveState().data()
        try:
            self.files.kept.keep_session(self.files.present_project)
            self.files.kept.keep_shape(WindowShape(bytes(geometry), bytes(docks)))
        except UserError as error:
            self._status.show_problem(str(error))


_TITLE_BESIDE = QDockWidget.DockWidgetFeature.DockWidgetVerticalTitleBar
_TABS_ABOVE = QTabWidget.TabPosition.North

"""The window: the picture, the docks around it, the menus, and a line for messages."""

from collections.abc import Callable
from pathlib import Path

from platformdirs import user_pictures_path
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import (
    QDockWidget,
    QFrame,
    QLabel,
    QScrollArea,
    QTabWidget,
    QWidget,
)

from vrut_lite.app.engine.day_scout import DayScout
from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.export import export_picture
from vrut_lite.app.engine.roster import Roster
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.session_project import inputs_of, project_of
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.panels.time_panel import TimePanel
from vrut_lite.app.view.profiler_overlay import ProfilerOverlay
from vrut_lite.app.view.sun_path import SunPath
from vrut_lite.app.view.viewport import CameraMode, Viewport
from vrut_lite.app.window.actions import ActionSpec
from vrut_lite.app.window.command_palette import CommandPalette
from vrut_lite.app.window.commanded_window import CommandedWindow
from vrut_lite.app.window.desk import Desk
from vrut_lite.app.window.docks import DOCKS, GROUPS, DockSpec, module_docks
from vrut_lite.app.window.kept import Kept, WindowShape
from vrut_lite.app.window.keys import KeyJudge
from vrut_lite.app.window.menus import Menus
from vrut_lite.app.window.screenshot import save_screenshot
from vrut_lite.app.window.shortcut_list import ShortcutList
from vrut_lite.app.window.status_line import StatusLine
from vrut_lite.daylight.scene import LoadScene, SceneOpened
from vrut_lite.daylight.sun import SunMoved
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.project import PROJECT_SUFFIX, Project, load_project, save_project

TITLE = "vrut_lite"
_RIGHT_PX = 420


class MainWindow(CommandedWindow):
    """The window of one session; closing it closes the session."""

    def __init__(
        self, session: Session, presets: PresetStore | None = None, kept: Kept | None = None
    ):
        super().__init__()
        self.kept = kept or Kept(None)
        self.setWindowTitle(TITLE)
        self.session = session
        sun_path = SunPath(self)
        self.desk: Desk = Desk(
            session=session,
            scout=DayScout(session, self),
            sun_path=sun_path,
            viewport=Viewport(session, sun_path),
            presets=presets or PresetStore(),
        )
        # Where screenshots go.
        self.pictures = user_pictures_path() / TITLE
        self.docks: dict[str, QDockWidget] = {}
        self.panels: dict[str, QWidget] = {}
        self._keys = KeyJudge(self)
        self.setCentralWidget(self.desk.viewport)
        self.profiler: ProfilerOverlay = ProfilerOverlay(session, self.desk.viewport)
        self._status = StatusLine()
        self.setStatusBar(self._status)
        self.menus = Menus(self, lambda: self.kept.recent)
        self.actions_by_name = self.menus.actions
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
        dock.setWidget(_scrolled(panel) if spec.scrolled else panel)
        # The dock's tab shows its title.
        dock.setTitleBarWidget(QWidget())
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
                           lambda window, on: window.toggle_dock(spec.name))
            )  # fmt: skip

    def _arrange(self) -> None:
        self.setDockNestingEnabled(True)
        self.setTabPosition(Qt.DockWidgetArea.AllDockWidgetAreas, _TABS_ABOVE)
        right = [dock for dock in self.docks.values() if dock.property("group") != "time"]
        self.resizeDocks(right, [_RIGHT_PX] * len(right), Qt.Orientation.Horizontal)
        self.resizeDocks(
            [self.docks["place"], self.docks["sky"]], [430, 440], Qt.Orientation.Vertical
        )
        self.docks["place"].raise_()
        self.docks["sky"].raise_()

    def _connect(self) -> None:
        session, desk = self.session, self.desk
        desk.scout.day_changed.connect(desk.sun_path.set_day)
        session.listen(SunMoved, desk.sun_path.set_sun)
        session.listen(SceneOpened, self._scene_loaded)
        session.ready.connect(self._ready)
        session.problem.connect(self.show_problem)
        session.picture_shown.connect(self._show_facts)
        session.steps_changed.connect(self.menus.show_steps)
        desk.viewport.scene_dropped.connect(self.open_path)
        desk.viewport.mode_changed.connect(self._mode_changed)

    # --- actions -----------------------------------------------------------------------------

    def open_path(self, path: str) -> None:
        """Open a scene or a project; a file that cannot be opened changes nothing."""
        if Path(path).suffix.lower() != PROJECT_SUFFIX:
            self.show_news(f"Opening {path} \N{HORIZONTAL ELLIPSIS}")
            self.session.send(LoadScene(path=path))
            return
        try:
            self.open_project(load_project(path))
            self.kept.add_recent(path)
        except UserError as error:
            self.show_problem(str(error))

    def open_project(self, project: Project) -> None:
        """Show a project."""
        self.session.ask(
            lambda stage: inputs_of(project, stage.kernel),
            lambda inputs: self.session.begin_with(*inputs),
        )

    def save(self, path: str) -> None:
        """Save the project."""
        self._guarded(lambda: save_project(path, project_of(self.session)), f"Saved {path}")

    def export(self, path: str) -> None:
        """Write the picture."""
        export_picture(self.session, path, self.show_news)

    def save_screenshot(self) -> None:
        """Write the picture as it looks now into the folder `pictures`."""
        try:
            self.show_news(f"Saved {save_screenshot(self.desk, self.pictures)}")
        except UserError as error:
            self.show_problem(str(error))

    def show_dock(self, name: str) -> None:
        """Show a dock, as the front tab of its group."""
        self.docks[name].show()
        self.docks[name].raise_()

    def toggle_dock(self, name: str) -> None:
        """Hide a dock that is seen; show one that is not."""
        if self.panels[name].visibleRegion().isEmpty():
            self.show_dock(name)
        else:
            self.docks[name].hide()

    def show_palette(self) -> None:
        """Open the command palette."""
        palette = CommandPalette(self)
        palette.show()
        palette.text_field.setFocus()

    def show_keys(self) -> None:
        """Open the list of keys."""
        ShortcutList(self.menus.specs, self).show()

    def _guarded(self, act: Callable[[], None], done: str = "") -> None:
        try:
            act()
        except UserError as error:
            self.show_problem(str(error))
        else:
            if done:
                self.show_news(done)

    def undo(self) -> None:
        """Undo the last change."""
        self.session.undo(lambda title: self.show_news(f"Taken back: {title}" if title else ""))

    def redo(self) -> None:
        """Redo the change that was undone last."""
        self.session.redo(lambda title: self.show_news(f"Done again: {title}" if title else ""))

    # --- messages ----------------------------------------------------------------------------

    def show_problem(self, line: str) -> None:
        """One line on what went wrong."""
        self._status.show_problem(line)

    def show_news(self, line: str) -> None:
        """One line on what was done."""
        self._status.show_news(line)

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
        shape = self.kept.shape()
        if shape is not None:
            self.restoreGeometry(shape.geometry)
            self.restoreState(shape.docks)

    def _scene_loaded(self, scene: SceneOpened) -> None:
        self.setWindowTitle(f"{Path(scene.path).name} \N{EN DASH} {TITLE}")
        self.show_news(f"{Path(scene.path).name}: {scene.triangles:,} triangles")
        self._guarded(lambda: self.kept.add_recent(scene.path))

    def _mode_changed(self, mode: CameraMode) -> None:
        self.actions_by_name[mode.name.lower()].setChecked(True)
        self.show_news(mode.value)

    def _show_facts(self, shown: Shown) -> None:
        self._status.show_facts(shown, self.session.roster.renderer)

    # --- the end -----------------------------------------------------------------------------

    def close_soon(self) -> None:
        """Close, after the event that asked for it."""
        QTimer.singleShot(0, self.close)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Hide at once; threads that still run end without a window."""
        if not self.session.has_ended:
            self._guarded(self._keep)
            self.time.player.pause()
            self.session.close()
        self.hide()
        event.accept()

    def _keep(self) -> None:
        """Keep the project and the window's layout for the next start, if the host was opened."""
        if self.session.roster.modules:
            self.kept.keep_session(project_of(self.session))
            geometry, docks = self.saveGeometry().data(), self.saveState().data()
            self.kept.keep_shape(WindowShape(bytes(geometry), bytes(docks)))


_TABS_ABOVE = QTabWidget.TabPosition.North


def _scrolled(panel: QWidget) -> QScrollArea:
    area = QScrollArea()
    area.setWidgetResizable(True)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    area.setWidget(panel)
    return area

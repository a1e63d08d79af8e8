"""The window: the picture, the docks around it, the menus, and a line for messages."""

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QAction, QActionGroup, QCloseEvent, QKeySequence
from PySide6.QtWidgets import (
    QDockWidget,
    QFileDialog,
    QFrame,
    QLabel,
    QMainWindow,
    QMenu,
    QScrollArea,
    QTabWidget,
    QWidget,
)

from vrut_lite.app import theme
from vrut_lite.app.actions import ACTIONS, ActionSpec
from vrut_lite.app.day_scout import DayScout
from vrut_lite.app.desk import Desk
from vrut_lite.app.docks import DOCKS, GROUPS, DockSpec, module_docks
from vrut_lite.app.engine import Shown
from vrut_lite.app.export import export_picture
from vrut_lite.app.panels.time_panel import TimePanel
from vrut_lite.app.presets import PresetStore
from vrut_lite.app.project_keeper import ProjectKeeper, inputs_of, save_project
from vrut_lite.app.roster import Roster
from vrut_lite.app.session import Session
from vrut_lite.app.sun_path import SunPath
from vrut_lite.app.viewport import CameraMode, Viewport
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import LoadScene, SceneLoaded, SunMoved
from vrut_lite.project import PROJECT_SUFFIX, Project, load_project

TITLE = "vrut_lite"
_RIGHT_PX = 420
_NEWS_MS = 12_000
_FILES = "Scenes and projects (*.glb *.gltf *.obj *.toml)"


class MainWindow(QMainWindow):
    """One session's window; when it is closed, the session is."""

    def __init__(self, session: Session, presets: PresetStore | None = None):
        super().__init__()
        self.setWindowTitle(TITLE)
        self.session = session
        sun_path = SunPath(self)
        self.desk: Desk = Desk(
            session=session,
            scout=DayScout(session, self),
            keeper=ProjectKeeper(session),
            sun_path=sun_path,
            viewport=Viewport(session, sun_path),
            presets=presets or PresetStore(),
        )
        self.docks: dict[str, QDockWidget] = {}
        self.panels: dict[str, QWidget] = {}
        self.actions_by_name: dict[str, QAction] = {}
        self.setCentralWidget(self.desk.viewport)
        self._make_status()
        self._make_menus()
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

    # --- what it is made of ------------------------------------------------------------------

    def add_dock(self, spec: DockSpec) -> None:
        """Make a dock; it joins the tabs of its group."""
        panel = spec.make(self.desk)
        dock = QDockWidget(spec.title, self)
        dock.setObjectName(spec.name)
        dock.setWidget(_scrolled(panel) if spec.scrolled else panel)
        # Its tab is title enough.
        dock.setTitleBarWidget(QWidget())
        group = [dock for dock in self.docks.values() if dock.property("group") == spec.group]
        dock.setProperty("group", spec.group)
        self.addDockWidget(GROUPS[spec.group], dock)
        if group:
            self.tabifyDockWidget(group[-1], dock)
        dock.setVisible(spec.shown)
        self.docks[spec.name], self.panels[spec.name] = dock, panel
        self._panels_menu.addAction(dock.toggleViewAction())

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

    def _make_status(self) -> None:
        self.news = QLabel()
        self.news.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.facts = QLabel()
        self.facts.setProperty("role", "faint")
        self.statusBar().addWidget(self.news, 1)
        self.statusBar().addPermanentWidget(self.facts)
        self.statusBar().setSizeGripEnabled(False)
        self._news_fades = QTimer(self)
        self._news_fades.setSingleShot(True)
        self._news_fades.setInterval(_NEWS_MS)
        self._news_fades.timeout.connect(self.news.clear)

    def _make_menus(self) -> None:
        menus: dict[str, QMenu] = {}
        groups: dict[str, QActionGroup] = {}
        for spec in ACTIONS:
            if spec.menu not in menus:
                menus[spec.menu] = self.menuBar().addMenu(spec.menu)
            action = self._action(spec)
            menus[spec.menu].addAction(action)
            if spec.group:
                groups.setdefault(spec.group, QActionGroup(self)).addAction(action)
        self._panels_menu = menus["View"].addMenu("Panels")
        self.actions_by_name["orbit"].setChecked(True)

    def _action(self, spec: ActionSpec) -> QAction:
        action = QAction(spec.title, self)
        action.setShortcut(QKeySequence(spec.keys))
        action.setCheckable(spec.checkable)
        action.triggered.connect(lambda on, spec=spec: spec.act(self, bool(on)))
        self.actions_by_name[spec.name] = action
        return action

    def _connect(self) -> None:
        session, desk = self.session, self.desk
        desk.scout.day_changed.connect(desk.sun_path.set_day)
        session.listen(SunMoved, desk.sun_path.set_sun)
        session.listen(SceneLoaded, self._scene_loaded)
        session.ready.connect(self._ready)
        session.problem.connect(self.show_problem)
        session.picture_shown.connect(self._show_facts)
        session.ended.connect(self._ended)
        desk.viewport.scene_dropped.connect(self.open_path)
        desk.viewport.mode_changed.connect(self._mode_changed)

    # --- what can be done --------------------------------------------------------------------

    def open_path(self, path: str) -> None:
        """Open a scene, or a project; what cannot be opened leaves the old scene as it is."""
        if Path(path).suffix.lower() != PROJECT_SUFFIX:
            self.show_news(f"Opening {path} \N{HORIZONTAL ELLIPSIS}")
            self.session.send(LoadScene(path=path))
            return
        try:
            self.open_project(load_project(path))
        except UserError as error:
            self.show_problem(str(error))

    def open_project(self, project: Project) -> None:
        """Become what a project says."""
        self.session.ask(
            lambda stage: inputs_of(project, stage.kernel),
            lambda inputs: self.session.send(*inputs),
        )

    def save(self, path: str) -> None:
        """Save the project."""
        self._guarded(lambda: save_project(path, self.desk.keeper.project), f"Saved {path}")

    def export(self, path: str) -> None:
        """Write the picture."""
        project = self.desk.keeper.project
        self.session.ask(lambda stage: export_picture(stage, path, project), self.show_news)

    def ask_to_open(self) -> None:
        """Let a file be chosen, and open it."""
        path, _ = QFileDialog.getOpenFileName(self, "Open", self._folder(), _FILES)
        if path:
            self.open_path(path)

    def ask_to_save(self) -> None:
        """Let a name be chosen, and save the project."""
        path, _ = QFileDialog.getSaveFileName(
            self, "Save project", self._folder(), "Projects (*.toml)"
        )
        if path:
            self.save(path if path.endswith(PROJECT_SUFFIX) else path + PROJECT_SUFFIX)

    def ask_to_export(self) -> None:
        """Let a name be chosen, and write the picture."""
        path, _ = QFileDialog.getSaveFileName(
            self, "Export picture", self._folder(), "Pictures (*.png *.exr)"
        )
        if path:
            self.export(path)

    def _folder(self) -> str:
        scene = self.desk.keeper.project.scene
        return str(Path(scene).resolve().parent) if scene else ""

    def _guarded(self, act: Callable[[], None], done: str) -> None:
        try:
            act()
        except UserError as error:
            self.show_problem(str(error))
        else:
            self.show_news(done)

    # --- what is told ------------------------------------------------------------------------

    def show_problem(self, line: str) -> None:
        """One line on what went wrong."""
        self._tell(line, theme.ALARM)

    def show_news(self, line: str) -> None:
        """One line on what was done."""
        self._tell(line, theme.TEXT)

    def _tell(self, line: str, colour: str) -> None:
        self.news.setText(line)
        self.news.setToolTip(line)
        self.news.setStyleSheet(f"color: {colour}; padding-left: 6px;")
        self._news_fades.start()

    def _ready(self, roster: Roster) -> None:
        for spec in module_docks(roster):
            self.add_dock(spec)
        self._arrange()

    def _scene_loaded(self, scene: SceneLoaded) -> None:
        self.setWindowTitle(f"{Path(scene.path).name} \N{EN DASH} {TITLE}")
        self.show_news(f"{Path(scene.path).name}: {scene.triangles:,} triangles")

    def _mode_changed(self, mode: CameraMode) -> None:
        self.actions_by_name[mode.name.lower()].setChecked(True)
        self.show_news(mode.value)

    def _show_facts(self, shown: Shown) -> None:
        height, width = shown.picture.display.shape[:2]
        self.facts.setText(
            f"{width} \N{MULTIPLICATION SIGN} {height}   {1e3 * shown.seconds:.0f} ms   "
            f"{_short(self.session.roster.renderer)}   "
        )

    # --- the end -----------------------------------------------------------------------------

    def close_soon(self) -> None:
        """Close, after the event that asked for it."""
        QTimer.singleShot(0, self.close)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Vanish at once; what still runs is waited for without a window."""
        if not self.session.has_ended:
            self.time.player.pause()
            self.desk.scout.close()
            self.session.close()
        self.hide()
        event.accept()

    def _ended(self) -> None:
        """The engine is gone, by our wish or because it could not begin."""
        self.desk.scout.close()


_TABS_ABOVE = QTabWidget.TabPosition.North


def _scrolled(panel: QWidget) -> QScrollArea:
    area = QScrollArea()
    area.setWidgetResizable(True)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    area.setWidget(panel)
    return area


def _short(renderer: str) -> str:
    """Without what stands in brackets."""
    return renderer.partition(" (")[0]

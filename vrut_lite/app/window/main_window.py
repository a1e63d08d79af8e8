"""The window: the picture, the docks around it, the menus, and the status line."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import msgspec
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import (
    QLabel,
    QMainWindow,
)

from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.module_catalogue import ModuleCatalogue
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.engine.sun_day_finder import SunDayFinder
from vrut_lite.app.headset.headset import Headset
from vrut_lite.app.panels.module_manager import ModuleManager
from vrut_lite.app.panels.picture_panel import PicturePanel
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.panels.time_panel import TimePanel
from vrut_lite.app.view.compass import Compass
from vrut_lite.app.view.hand import CameraMode
from vrut_lite.app.view.look_at import look_at_moon, look_at_sun
from vrut_lite.app.view.profiler_overlay import ProfilerOverlay
from vrut_lite.app.view.sun_path import SunPath
from vrut_lite.app.view.viewport import Viewport
from vrut_lite.app.window.about_box import AboutBox, graphics_of
from vrut_lite.app.window.actions import action_specs
from vrut_lite.app.window.command_palette import (
    CommandPalette,
    action_entries,
    choice_entries,
    dock_entries,
    recent_entries,
    slot_entries,
)
from vrut_lite.app.window.dock_board import DockBoard
from vrut_lite.app.window.files import Files
from vrut_lite.app.window.kept import Kept, WindowShape
from vrut_lite.app.window.logged_warnings import LoggedWarnings
from vrut_lite.app.window.manual_window import show_manual
from vrut_lite.app.window.menus import Menus
from vrut_lite.app.window.panel_context import PanelContext
from vrut_lite.app.window.shortcut_list import ShortcutList
from vrut_lite.app.window.status_line import StatusLine
from vrut_lite.app.window.views import Views
from vrut_lite.bundled.manual import manual_start
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import EnableModule, Input, SettingChanged
from vrut_lite.messages.night import NightLightChanged
from vrut_lite.messages.picture import SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.messages.sun import SunMoved

TITLE = "vrut_lite"

# The axis that a notice on axes names (`vrut_lite.scene.loading`).
_NAMED_AXIS = re.compile(r"else --up ([yz])\b")


class MainWindow(QMainWindow):
    """The window of one session; closing it closes the session."""

    def __init__(
        self, session: Session, presets: PresetStore | None = None, kept: Kept | None = None
    ):
        super().__init__()
        self.setWindowTitle(f"{TITLE}[*]")
        self.session = session
        sun_path, compass = SunPath(self), Compass(self)
        self.desk: PanelContext = PanelContext(
            session=session,
            scout=SunDayFinder(session, self),
            sun_path=sun_path,
            compass=compass,
            viewport=Viewport(session, sun_path, compass),
            presets=presets or PresetStore(),
        )
        self.setCentralWidget(self.desk.viewport)
        self.profiler: ProfilerOverlay = ProfilerOverlay(session, self.desk.viewport)
        self.headset = Headset(session, self.desk.viewport, self)
        self._status = StatusLine()
        self._warnings = LoggedWarnings(self)
        self._opened: LoadScene | None = None
        self.setStatusBar(self._status)
        self.files = Files(self, self.desk, kept or Kept(None), self._status, self._show_title)
        self._may_close = False
        self.menus = Menus(
            self,
            action_specs(self, self.desk, self.files, self.profiler),
            lambda: self.files.kept.recent,
            self.files.ask_and_open,
        )
        self.actions_by_name = self.menus.actions
        self.files.views = Views(self.menus.views, self.desk.viewport.go_to)
        self.board = DockBoard(self, self.desk, self.menus)
        self.docks, self.panels = self.board.docks, self.board.panels
        self._connect()

    @property
    def time(self) -> TimePanel:
        """The time bar's panel."""
        panel = self.panels["time"]
        assert isinstance(panel, TimePanel)
        return panel

    @property
    def modules(self) -> ModuleManager:
        """The panel of all modules."""
        panel = self.panels["modules"]
        assert isinstance(panel, ModuleManager)
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

    def _connect(self) -> None:
        session, desk = self.session, self.desk
        desk.scout.day_changed.connect(desk.sun_path.set_day)
        desk.scout.moon_changed.connect(desk.sun_path.set_moon_day)
        session.listen(SunMoved, desk.sun_path.set_sun)
        session.listen(NightLightChanged, desk.sun_path.set_moon)
        session.listen(SettingChanged, self.menus.show_section)
        session.listen(SettingChanged, self.menus.show_values)
        session.listen(SetPlace, desk.sun_path.set_place)
        session.listen(SetPlace, desk.compass.set_place)
        session.listen(SceneOpened, self._scene_loaded)
        session.listen(SetExposure, self.menus.show_exposure)
        session.ready.connect(self._ready)
        session.problem.connect(self._status.show_problem)
        self._warnings.logged.connect(self._status.show_warning)
        session.picture_shown.connect(self._show_facts)
        session.steps_changed.connect(self.menus.show_steps)
        self.headset.changed.connect(self.menus.show_vr)
        self.headset.news.connect(self._status.show_news)
        desk.viewport.scene_dropped.connect(self.files.ask_and_open)
        self.files.unsaved.changed.connect(self.setWindowModified)
        desk.viewport.mode_changed.connect(self._mode_changed)
        if self.files.kept.switched_off:
            session.begin_by(self._switch_off)

    # --- actions -----------------------------------------------------------------------------

    def show_dock(self, name: str) -> None:
        """Show a dock, as the front tab of its group."""
        self.board.show(name)

    def go_to_dock(self, name: str) -> None:
        """Show a dock, and give the keys to its first control."""
        self.board.go_to(name)

    def type_time(self, field: Literal["clock", "date"]) -> None:
        """Give the keys to the field of the hour, or of the date."""
        self.show_dock("time")
        getattr(self.time, field).setFocus(Qt.FocusReason.TabFocusReason)

    def toggle_dock(self, name: str) -> None:
        """Hide a visible dock; show a hidden one."""
        self.board.toggle(name)

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
            *choice_entries(self.session),
            *recent_entries(self.files.kept.recent, self.files.ask_and_open),
        ]
        return CommandPalette(self, entries)

    def show_keys(self) -> None:
        """Open the list of keys."""
        ShortcutList(self.menus.specs, self).show()

    def look_at_sun(self) -> None:
        """Turn the camera to the sun, or say why not."""
        self._look(look_at_sun)

    def look_at_moon(self) -> None:
        """Turn the camera to the moon, or say why not."""
        self._look(look_at_moon)

    def _look(self, look: Callable[[Session, SunDayFinder, Viewport], None]) -> None:
        try:
            look(self.session, self.desk.scout, self.desk.viewport)
        except UserError as error:
            line = str(error)
            self._status.show_news(line[:1].upper() + line[1:])

    def show_manual(self) -> None:
        """Open the manual in the browser, or in a window."""
        try:
            show_manual(manual_start(), self)
        except UserError as error:
            self._status.show_problem(str(error))

    def show_about(self) -> None:
        """Open the dialog of versions, graphics and folders, once the engine has named them."""
        self.session.ask(graphics_of, lambda graphics: AboutBox(graphics, self).show())

    def toggle_vr(self) -> None:
        """Show the scene in a headset, or no more."""
        self.headset.toggle()

    def undo(self) -> None:
        """Undo the last change."""
        self.session.undo(lambda title: self._status.show_news(f"Undone: {title}" if title else ""))

    def redo(self) -> None:
        """Redo the change that was undone last."""
        self.session.redo(lambda title: self._status.show_news(f"Redone: {title}" if title else ""))

    # --- messages ----------------------------------------------------------------------------

    def _ready(self, catalogue: ModuleCatalogue) -> None:
        for failure in self.board.add_modules(catalogue):
            self.session.problem.emit(failure)
        shape = self.files.kept.shape()
        if shape is not None:
            self.restoreGeometry(shape.geometry)
            self.restoreState(shape.docks)

    def _scene_loaded(self, scene: SceneOpened) -> None:
        self._show_title()
        news = f"{Path(scene.path).name}: {scene.triangles:,} triangles"
        # An animated scene posts `SceneOpened` in each pose.
        if scene.opened is None or scene.opened != self._opened:
            self._status.show_notices(news, scene.notices)
            self._offer_axis(scene)
            self.files.add_recent(scene.path)
            self.files.scene_opened(scene)
        self._opened = scene.opened

    def _offer_axis(self, scene: SceneOpened) -> None:
        """Offer the vertical axis that a notice names: one click instead of the Scene panel."""
        named = next(filter(None, map(_NAMED_AXIS.search, scene.notices)), None)
        if named is None or scene.opened is None:
            return
        placement = msgspec.structs.replace(scene.opened.placement, up=named[1])
        turned = msgspec.structs.replace(scene.opened, placement=placement)
        title = f"Up: {named[1].upper()}"
        tip = f"Let the scene stand along +{named[1].upper()}"
        self._status.offer(title, tip, lambda: self.session.send(turned))

    def _switch_off(self, stage: Stage) -> list[Input]:
        """Inputs that switch off what was off when the last window was closed."""
        names = self.files.kept.switched_off & stage.kernel.seats.keys()
        return [EnableModule(module=name, enabled=False) for name in sorted(names)]

    def _show_title(self) -> None:
        """The project, the scene, the application, as far as there are such.

        Qt shows its mark of unsaved changes after the first name.
        """
        scene = self.session.last(SceneOpened)
        files = [self.files.project, Path(scene.path) if scene is not None else None]
        names = [file.name for file in files if file is not None]
        first, *others = [*names, TITLE]
        self.setWindowTitle(" \N{EN DASH} ".join([f"{first}[*]", *others]))

    def _mode_changed(self, mode: CameraMode) -> None:
        self.actions_by_name[mode.name.lower()].setChecked(True)
        self._status.show_news(mode.value)

    def _show_facts(self, shown: Shown) -> None:
        self._status.show_facts(shown, self.session.catalogue.renderer)

    # --- the end -----------------------------------------------------------------------------

    def close_soon(self) -> None:
        """Close, after the event that asked for it."""
        QTimer.singleShot(0, self.close)

    def close_now(self) -> None:
        """Close without a question: changes of a named project are in the kept session alone."""
        self._may_close = True
        self.close()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Hide at once; threads that still run end without a window.

        First the changes of a named project are saved or given up.
        """
        if self.files.has_unsaved and not self._may_close:
            event.ignore()
            self.files.leave(self.close_now)
            return
        if not self.session.has_ended:
            self._keep()
            self.time.player.pause()
            self.session.close()
            self._warnings.close()
        self.hide()
        event.accept()

    def _keep(self) -> None:
        """Keep the project and the window's layout for the next start, if the host was opened."""
        if not self.session.catalogue.modules:
            return
        geometry, docks = self.saveGeometry().data(), self.saveState().data()
        try:
            self.files.kept.keep_session(self.files.present_project)
            self.files.kept.keep_named(self.files.named)
            self.files.kept.keep_shape(WindowShape(bytes(geometry), bytes(docks)))
            if (names := self.modules.switched_off) is not None:
                self.files.kept.keep_switched_off(names)
        except UserError as error:
            self._status.show_problem(str(error))

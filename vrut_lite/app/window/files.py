"""The commands of the File menu: open, save, screenshot, and their file dialogs."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import msgspec
from platformdirs import user_pictures_path
from PySide6.QtWidgets import QFileDialog, QInputDialog, QMessageBox, QWidget

from vrut_lite.app.engine.session import one_line
from vrut_lite.app.engine.session_project import folder_of, foretold, inputs_of, project_of
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.panels.file_title import file_title
from vrut_lite.app.window.kept import Kept, NamedProject
from vrut_lite.app.window.panel_context import PanelContext
from vrut_lite.app.window.refused_files import RefusedFiles
from vrut_lite.app.window.screenshot import save_screenshot
from vrut_lite.app.window.status_line import StatusLine
from vrut_lite.app.window.unsaved import Unsaved
from vrut_lite.app.window.views import Views
from vrut_lite.bundled.places import is_bundled
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Fault, Input, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.messages.weather import SetWeather
from vrut_lite.project import (
    PROJECT_ENDING,
    PROJECT_SUFFIX,
    CameraView,
    Project,
    load_project,
    save_project,
    weather_inputs,
)
from vrut_lite.scene.ifc_site import place_of_ifc
from vrut_lite.scene.scene_files import SUFFIXES
from vrut_lite.scene.settings import SCENE
from vrut_lite.weather.weather_file import read_weather

_TO_OPEN = f"Scenes and projects ({' '.join(f'*{one}' for one in (*SUFFIXES, PROJECT_SUFFIX))})"


class Files:
    """Files of one window; the status line shows results, a dialog why files were refused.

    Screenshots go to the folder `pictures`.
    """

    def __init__(
        self,
        window: QWidget,
        desk: PanelContext,
        kept: Kept,
        status: StatusLine,
        title_changed: Callable[[], None],
    ):
        self._desk, self._session, self._status = desk, desk.session, status
        self._window = window
        self.kept = kept
        self.refused = RefusedFiles(window)
        self.unsaved = Unsaved(desk.session, lambda: self.present_project, window)
        # The question on unsaved work, while it is open.
        self.question: QMessageBox | None = None
        # Names of the files that modules were asked to read, by module.
        self._reading: dict[str, str] = {}
        # The window sets them once it has its menus.
        self.views: Views
        # The project that was opened or saved last, if no other scene was opened since.
        self.project: Path | None = None
        # The place that a scene's own file states, until that scene is open.
        self._place_of: tuple[str, SetPlace] | None = None
        # The open project, whose inputs of `vrut-lite daylight` are kept.
        self._opened = Project()
        self.title_changed = title_changed
        self.pictures = user_pictures_path() / "vrut_lite"
        self._session.present_project = lambda: self.present_project
        self._session.refused.connect(self._refuse)
        self._session.sent.connect(self._note_reading)
        self._session.listen(Fault, self._note_fault)

    def ask_and_open(self, path: str) -> None:
        """Open a scene or a project, once the present project's changes are saved or given up."""
        self.leave(partial(self.open_path, path))

    def open_path(self, path: str) -> None:
        """Open a scene or a project; a file that cannot be opened changes nothing."""
        if Path(path).suffix.lower() != PROJECT_SUFFIX:
            self.project, self._opened = None, Project()
            place = place_of_ifc(path)
            self._place_of = None if place is None else (path, place)
            self._session.send(LoadScene(path=path))
            self.unsaved.begin()
            return
        try:
            self.open_named(load_project(path), NamedProject(path))
        except UserError as error:
            self._refuse(str(error))

    def name_project(self, path: str) -> None:
        """The open project is that of a file: it is saved there. An example is nobody's file:
        saving asks for a name."""
        self.project = None if is_bundled(Path(path)) else Path(path)
        self.title_changed()
        self.add_recent(path)

    def open_named(self, project: Project, named: NamedProject) -> None:
        """Show a project that has a file, from which it may differ."""
        self.open_project(project)
        self.name_project(named.path)
        if named.is_changed:
            self.unsaved.mark_changed()

    @property
    def named(self) -> NamedProject | None:
        """The present project's file."""
        if self.project is None:
            return None
        return NamedProject(str(self.project.resolve()), self.unsaved.is_changed)

    def scene_opened(self, scene: SceneOpened) -> None:
        """Go to the place that the scene's own file states, once it has opened."""
        if self._place_of is not None and self._place_of[0] == scene.path:
            self._session.send(self._place_of[1])
        self._place_of = None

    def add_recent(self, path: str) -> None:
        """Note an opened file for the list of recent ones."""
        try:
            self.kept.add_recent(path)
        except UserError as error:
            self._status.show_problem(str(error))

    def open_project(self, project: Project) -> None:
        """Show a project."""
        self.views.show(project.views)
        self._opened = project
        if project.scene:
            self._desk.viewport.loading.begin(project.scene)
            self._reading[SCENE] = Path(project.scene).name
        self._session.foretell(*foretold(project))
        self._session.begin_by(lambda stage: inputs_of(project, stage.kernel))
        self.unsaved.begin()

    def save(self, path: str) -> bool:
        """Save the project; whether it could be written."""
        try:
            save_project(path, self.present_project)
        except UserError as error:
            self._refuse(str(error))
            return False
        self.name_project(path)
        self.unsaved.saved()
        self._status.show_news(f"Saved {path}")
        return True

    def save_or_ask(self) -> None:
        """Save the project to its file; without one let a name be chosen."""
        if self.project is None:
            self.ask_to_save()
        else:
            self.save(str(self.project))

    @property
    def has_unsaved(self) -> bool:
        """Whether a named project has changes that its file lacks."""
        is_named = self.project is not None and not self._session.has_ended
        return is_named and self.unsaved.is_changed

    def leave(self, then: Callable[[], object]) -> None:
        """Call `then` once the changes of a named project are saved or given up.

        The last session comes back by itself: work without a project's name is not lost.
        """
        project = self.project
        if project is None or not self.has_unsaved:
            then()
            return
        if self.question is not None:
            self.question.close()
        question = self.question = QMessageBox(self._window)
        question.setIcon(QMessageBox.Icon.Question)
        question.setWindowTitle("Unsaved changes")
        question.setText(f"Save the changes of {project.name}?")
        question.setInformativeText("Without that they are lost.")
        buttons = QMessageBox.StandardButton
        question.setStandardButtons(buttons.Save | buttons.Discard | buttons.Cancel)
        question.setDefaultButton(buttons.Save)

        def answered(_result: int) -> None:
            self.question = None
            chosen = question.standardButton(question.clickedButton())
            question.deleteLater()
            if chosen == buttons.Discard or (chosen == buttons.Save and self.save(str(project))):
                then()

        question.finished.connect(answered)
        # The window goes on: nothing waits for the answer.
        question.open()

    # --- files that are refused --------------------------------------------------------------

    def _refuse(self, line: str) -> None:
        self._status.show_problem(line)
        self.refused.add(line)

    def _note_reading(self, message: Input) -> None:
        match message:
            case LoadScene():
                self._reading[SCENE] = Path(message.path).name
            case SetSetting() if message.module in self._session.catalogue.modules:
                spec = self._session.catalogue.modules[message.module].specs.get(message.name)
                if spec is not None and spec.file_kinds and message.value:
                    self._reading[message.module] = Path(str(message.value)).name

    def _note_fault(self, fault: Fault) -> None:
        name = self._reading.get(fault.module)
        if fault.for_user and name and name in fault.error:
            self.refused.add(one_line(fault.error))

    @property
    def present_project(self) -> Project:
        """The window's present state as a project, with its views, sensors and measured
        glazing."""
        return msgspec.structs.replace(
            project_of(self._session),
            views=self.views.kept,
            sensors=self._opened.sensors,
            bsdf=self._opened.bsdf,
            lamp=self._opened.lamp,
            lighting=self._opened.lighting,
        )

    def ask_to_keep_view(self) -> None:
        """Let a name be chosen, and keep the camera by it; the project file has it once saved."""
        viewport = self._desk.viewport
        name, wanted = QInputDialog.getText(
            viewport, "Keep this view", "Name of the view:", text=self.views.next_name
        )
        if wanted and name.strip():
            self.views.keep(name.strip(), CameraView.of(viewport.camera))

    def save_screenshot(self) -> None:
        """Write the picture with its overlays into the folder `pictures`."""
        try:
            self._status.show_news(f"Saved {save_screenshot(self._desk, self.pictures)}")
        except UserError as error:
            self._status.show_problem(str(error))

    def open_weather(self, path: str) -> None:
        """Show the sky of a year of weather at its place; missing data are reported."""

        def inputs(stage: Stage) -> list[Input]:
            weather = read_weather(path)
            place, known = weather.place, self._session.last(SetPlace)
            if known is not None:
                offset = known.north_offset_rad
                place = msgspec.structs.replace(place, north_offset_rad=offset)
            return [*weather_inputs(weather, stage.kernel, {}), place]

        def show(messages: list[Input]) -> None:
            self._session.send(*messages)
            told = [line for m in messages if isinstance(m, SetWeather) for line in m.lacks]
            self._status.show_news("; ".join(told) or f"Opened {path}")

        self._session.ask(inputs, show, self._refuse)

    # --- with a dialog for the name ----------------------------------------------------------

    def ask_to_open(self) -> None:
        """Let a file be chosen, and open it."""
        path, _ = QFileDialog.getOpenFileName(
            self._desk.viewport, "Open", folder_of(self._session), _TO_OPEN
        )
        if path:
            self.ask_and_open(path)

    def ask_for_weather(self) -> None:
        """Let a year of weather be chosen, and open it."""
        path, _ = QFileDialog.getOpenFileName(
            self._desk.viewport, "Open weather", folder_of(self._session), "Weather (*.epw)"
        )
        if path:
            self.open_weather(path)

    def ask_to_save(self) -> None:
        """Let a name be chosen, and save the project."""
        proposed = self.project or Path(
            folder_of(self._session), file_title(self._session) + PROJECT_ENDING
        )
        path, _ = QFileDialog.getSaveFileName(
            self._desk.viewport, "Save project as", str(proposed), "Projects (*.toml)"
        )
        if path:
            self.save(path if path.endswith(PROJECT_SUFFIX) else path + PROJECT_ENDING)

"""The commands of the File menu: open, save, screenshot, and their file dialogs."""

from collections.abc import Callable
from pathlib import Path

import msgspec
from platformdirs import user_pictures_path
from PySide6.QtWidgets import QFileDialog, QInputDialog

from vrut_lite.app.engine.session_project import folder_of, inputs_of, project_of
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.panels.file_title import file_title
from vrut_lite.app.window.kept import Kept
from vrut_lite.app.window.panel_context import PanelContext
from vrut_lite.app.window.screenshot import save_screenshot
from vrut_lite.app.window.status_line import StatusLine
from vrut_lite.app.window.views import Views
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Input
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.messages.weather import SetWeather
from vrut_lite.project import (
    PROJECT_SUFFIX,
    CameraView,
    Project,
    load_project,
    save_project,
    weather_inputs,
)
from vrut_lite.scene.ifc_site import place_of_ifc
from vrut_lite.scene.scene_files import SUFFIXES
from vrut_lite.weather.weather_file import read_weather

_TO_OPEN = f"Scenes and projects ({' '.join(f'*{one}' for one in (*SUFFIXES, PROJECT_SUFFIX))})"


class Files:
    """Files of one window; the status line shows results and errors.

    Screenshots go to the folder `pictures`.
    """

    def __init__(
        self, desk: PanelContext, kept: Kept, status: StatusLine, title_changed: Callable[[], None]
    ):
        self._desk, self._session, self._status = desk, desk.session, status
        self.kept = kept
        # The window sets them once it has its menus.
        self.views: Views
        # The project that was opened or saved last, if no other scene was opened since.
        self.project: Path | None = None
        # The place that a scene's own file states, until that scene is open.
        self._place_of: tuple[str, SetPlace] | None = None
        # The open project's file of sensors, which the window keeps for `vrut-lite daylight`.
        self._sensors = ""
        self.title_changed = title_changed
        self.pictures = user_pictures_path() / "vrut_lite"

    def open_path(self, path: str) -> None:
        """Open a scene or a project; a file that cannot be opened changes nothing."""
        if Path(path).suffix.lower() != PROJECT_SUFFIX:
            self.project, self._sensors = None, ""
            place = place_of_ifc(path)
            self._place_of = None if place is None else (path, place)
            self._session.send(LoadScene(path=path))
            return
        try:
            self.open_project(load_project(path))
        except UserError as error:
            self._status.show_problem(str(error))
        else:
            self.project = Path(path)
            self.title_changed()
            self.add_recent(path)

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
        self._sensors = project.sensors
        if project.scene:
            self._desk.viewport.loading.begin(project.scene)
        self._session.begin_by(lambda stage: inputs_of(project, stage.kernel))

    def save(self, path: str) -> None:
        """Save the project."""
        try:
            save_project(path, self.present_project)
        except UserError as error:
            self._status.show_problem(str(error))
        else:
            self.project = Path(path)
            self.title_changed()
            self.add_recent(path)
            self._status.show_news(f"Saved {path}")

    @property
    def present_project(self) -> Project:
        """The window's present state as a project, with its views and sensors."""
        return msgspec.structs.replace(
            project_of(self._session), views=self.views.kept, sensors=self._sensors
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

        self._session.ask(inputs, show)

    # --- with a dialog for the name ----------------------------------------------------------

    def ask_to_open(self) -> None:
        """Let a file be chosen, and open it."""
        path, _ = QFileDialog.getOpenFileName(
            self._desk.viewport, "Open", folder_of(self._session), _TO_OPEN
        )
        if path:
            self.open_path(path)

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
            folder_of(self._session), file_title(self._session) + PROJECT_SUFFIX
        )
        path, _ = QFileDialog.getSaveFileName(
            self._desk.viewport, "Save project", str(proposed), "Projects (*.toml)"
        )
        if path:
            self.save(path if path.endswith(PROJECT_SUFFIX) else path + PROJECT_SUFFIX)

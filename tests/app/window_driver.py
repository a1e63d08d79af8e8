"""A window as its user meets it: what tests of the application share."""

import gc
from datetime import UTC, datetime
from pathlib import Path

import msgspec
import numpy as np
from PySide6.QtCore import QCoreApplication, QEvent, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication

from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.session_project import project_of
from vrut_lite.app.engine.window_jobs import WindowJobs
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.theme import apply_theme
from vrut_lite.app.window.kept import Kept
from vrut_lite.app.window.main_window import MainWindow
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.kernel.messages import ClockMoved, SetClock
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene
from vrut_lite.pictures.exposure import ev100_of
from vrut_lite.pictures.picture import Picture
from vrut_lite.project import Project, load_project
from vrut_lite.scene.backend import SceneView
from vrut_lite.scene.manager import SceneManager

SCENES = Path(__file__).parents[2] / "scenes"
# Long enough for a machine that does much else; no test waits for it to pass.
PATIENCE_MS = 240_000
NOON = datetime(2026, 6, 21, 11, 0, tzinfo=UTC)
ZONE = "Europe/Prague"
# Inputs of an engine; the camera's follow.
SUNDIAL_AT_NOON = (
    Resize(width_px=64, height_px=36),
    SetPlace(latitude_deg=50.0, longitude_deg=14.4),
    SetClock(instant=NOON),
    LoadScene(path=str(SCENES / "sundial.glb")),
)
# Pixels of a window whose pictures are drawn, which takes long without a graphics card.
SMALL = (680, 440)


def choose(box, data):
    """Choose an entry of a drop-down as by the mouse: only that makes Qt emit `activated`."""
    box.setCurrentIndex(box.findData(data))
    box.activated.emit(box.currentIndex())


def move_pointer(view, position, button):
    """Move the pointer over a widget with a button held; QTest's own move sends no buttons."""
    event = QMouseEvent(
        QEvent.Type.MouseMove, QPointF(position), view.mapToGlobal(QPointF(position)),
        Qt.MouseButton.NoButton, button, Qt.KeyboardModifier.NoModifier,
    )  # fmt: skip
    QApplication.sendEvent(view, event)


class HeadlessStage:
    """A host without OpenGL: the scene is opened and lit, and drawn black."""

    renderer = "none"
    device = None

    def __init__(self):
        self.kernel, self.failures = daylight_kernel(WindowJobs())
        self._view = SceneView(self.kernel)
        self.kernel.add_module(SceneManager, view=self._view, cube_size=16)
        self.kernel.pump_until_idle()
        self.pass_seconds = {}
        self.frame_counters = WorkCounters()
        self.sizes = []

    def draw(self, state, still, is_given_up=None):
        width, height = state.size_px
        self.sizes.append((state.size_px, still))
        radiance = np.full((height, width, 3), self.radiance(state), np.float32)
        display = np.zeros(radiance.shape, np.uint8)
        # All pixels are alike: one is metered.
        return Picture(radiance, display, ev100_of(state.exposure, radiance[:1, :1]))

    def measure_next(self):
        pass

    def radiance(self, state):
        """Radiance of the whole picture, in W m^-2 sr^-1."""
        return 0.0

    @property
    def state(self):
        return self._view.state

    @property
    def revision(self):
        return self._view.revision

    def light_at_pixel(self, x, y):
        return None

    def surface_at_pixel(self, x, y):
        return None

    def close(self):
        self.kernel.close()


class WindowDriver:
    """Opens a window on the sundial, 21 June 2026, 13:00 in Prague."""

    def __init__(self, qtbot, open_stage, folder, size=(760, 520)):
        # Qt takes 0.1 s to style each window: those that nobody draws stay plain.
        app = QApplication.instance()
        if open_stage is HeadlessStage:
            app.setStyleSheet("")
        elif not app.styleSheet():
            apply_theme(app)
        self.qtbot = qtbot
        self.session = Session(open_stage)
        self.window = MainWindow(
            self.session, PresetStore(folder / "presets"), Kept(folder / "kept")
        )
        self.window.resize(*size)
        self.problems = []
        self.session.problem.connect(self.problems.append)
        self.heard = []
        self.session.heard.connect(lambda message, sender: self.heard.append(message))
        self.window.show()
        self.session.start()
        self.open(load_project(SCENES / "sundial.toml"))
        self.until(self._day_is_found)
        self.until(lambda: self.session.shown is not None)
        self.heard.clear()

    def _day_is_found(self):
        day = self.window.desk.scout.day
        return day is not None and day.zone.key == ZONE and day.start <= NOON < day.end

    def renew(self):
        """Open the project again: scene, place, hour, camera, settings are those of a new window,
        and nothing is left to undo."""
        self.window.time.player.pause()
        self.open(load_project(SCENES / "sundial.toml"))
        # The project's inputs are known after the first, and acted on after the second.
        self.settled()
        self.settled()
        self.until(self._day_is_found)
        self.window.news.clear()
        self.problems.clear()
        self.heard.clear()

    def open(self, project: Project):
        at = msgspec.structs.replace(project, at=NOON.isoformat())
        self.window.files.open_project(at)
        self.until(lambda: self.session.last(ClockMoved) is not None)

    @property
    def project(self):
        """What would be saved."""
        return project_of(self.session)

    def panel(self, name):
        return self.window.panels[name]

    def activated(self):
        """This driver, whose window gets the keys."""
        self.window.activateWindow()
        self.until(self.window.isActiveWindow)
        return self

    def click(self, widget):
        self.qtbot.mouseClick(widget, Qt.MouseButton.LeftButton)

    def type_in(self, field, text):
        """Type over a field's text and press Enter."""
        field.setFocus()
        field.selectAll()
        self.qtbot.keyClicks(field, text)
        self.qtbot.keyClick(field, Qt.Key.Key_Return)

    def until(self, condition):
        self.qtbot.waitUntil(condition, timeout=PATIENCE_MS)

    def until_heard(self, kind, condition=lambda message: True):
        """The first message of a type that was heard and is as wished."""

        def found():
            return [m for m in self.heard if isinstance(m, kind) and condition(m)]

        self.until(lambda: bool(found()))
        return found()[0]

    def settled(self):
        """Return when all that was sent has been acted on, and told here."""
        told = []
        self.session.ask(lambda stage: stage.kernel.pump_until_idle(), told.append)
        self.until(lambda: bool(told))

    def asked(self, question):
        """What the engine's thread answers."""
        told = []
        self.session.ask(question, told.append)
        self.until(lambda: bool(told))
        return told[0]

    def local(self):
        """What a clock at the place shows."""
        zone = self.window.desk.scout.day.zone
        return self.session.last(ClockMoved).instant.astimezone(zone)

    def close(self):
        self.window.close_now()
        assert self.session.join(PATIENCE_MS / 1000)
        # Connections hold what they call, unseen by Python: only Qt can end window and session.
        self.window.deleteLater()
        self.session.deleteLater()
        QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        # The rest is freed here, on Qt's thread: later the collector may run on any other.
        vars(self).clear()
        gc.collect()

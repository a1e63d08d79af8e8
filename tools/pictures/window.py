"""Pictures of the desktop application: the window with three scenes, and every panel on a sheet.

    xvfb-run -a -s "-screen 0 1920x1200x24" python -m tools.pictures.window FOLDER

Writes app_street.jpg, app_sundial.jpg, app_pavilion.jpg, app_compare.jpg and app_panels.jpg. On the
sheet panels are shown whole, also what a window would scroll.
"""

import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from datetime import timedelta
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication, QWidget

from tools.pictures.drawing import scene_project
from vrut_lite.app.compare.sky_disc import SkyDisc
from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.message_inspector import MessageInspector
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.theme import apply_theme
from vrut_lite.app.window.main_window import MainWindow
from vrut_lite.app.window.shortcut_list import ShortcutList
from vrut_lite.daylight.clouds import CloudsChanged
from vrut_lite.kernel.messages import ChooseSlot, ClockMoved, SetClock
from vrut_lite.project import CameraView, Project

STREET = scene_project("street.toml", at="2026-06-21T18:40")
# The camera looks up toward the morning's sun, over the dial.
SUNDIAL = scene_project(
    "sundial.glb",
    at="2026-06-21T10:00",
    slots={"sky": "bruneton_sky"},
    camera=CameraView(
        eye_m=(-7.0, 1.7, -2.5), target_m=(2.4, 5.8, 0.9), vertical_field_of_view_deg=66.0
    ),
)
PAVILION = scene_project(
    "pavilion.gltf",
    at="2026-05-21T16:30",
    settings={"clouds": {"coverage": 0.45}},
)
# Of the window alone, and where its docks are to be seen whole.
SIZE, LARGE = (1280, 800), (1600, 1000)
# Towards 45 degrees of height in the north: whose spectra are compared.
POINTED = (0.0, 0.7071, -0.7071)
# Panels of one width stand below each other, each column as wide as a dock.
_COLUMNS, _WIDTH_PX, _GAP_PX = 4, 420, 8
_BEHIND = (12, 12, 13)
_REST_S, _LIMIT_S = 1.5, 600.0

Pixels = NDArray[np.uint8]


class PosedWindow:
    """A window that can be waited for and looked at, part by part."""

    def __init__(self, app: QApplication, folder: Path):
        self._app = app
        self.session = Session()
        self.window = MainWindow(self.session, PresetStore(folder))
        self._shown: Shown | None = None
        self._shown_s = 0.0
        self.session.picture_shown.connect(self._note)
        self.window.resize(*SIZE)
        self.window.show()
        self.session.start()
        self.open(STREET)
        self.until(lambda: "module clouds" in self.window.docks)

    def _note(self, shown: Shown) -> None:
        self._shown, self._shown_s = shown, time.monotonic()

    def open(self, project: Project) -> None:
        """Become a project's picture."""
        self._shown = None
        self.window.files.open_project(project)
        self.finish()

    def finish(self) -> None:
        """Wait for a finished picture after which none has come for a while."""
        self.rest()
        self.until(
            lambda: (
                self._shown is not None
                and self._shown.still
                and time.monotonic() > self._shown_s + 2.0 * _REST_S
            )
        )

    def until(self, is_so: Callable[[], bool]) -> None:
        """Let events happen until something is so."""
        end = time.monotonic() + _LIMIT_S
        while not is_so():
            if time.monotonic() > end:
                raise TimeoutError("the window did not come to rest")
            self._app.processEvents()
            time.sleep(0.01)

    def rest(self) -> None:
        """Let events happen for a while."""
        end = time.monotonic() + _REST_S
        self.until(lambda: time.monotonic() > end)

    def panel(self, name: str) -> Pixels:
        """All of a panel, at the width of a dock."""
        self.window.show_dock(name)
        self.rest()
        return seen(self.window.panels[name])


def seen(widget: QWidget) -> Pixels:
    """What a widget looks like (height, width, 3)."""
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), -1)
    return rows[:, : 3 * image.width()].reshape(image.height(), -1, 3).copy()


def trimmed(part: Pixels) -> Pixels:
    """A part without what is empty below it."""
    filled = np.flatnonzero((part != part[-3, 8]).any(axis=-1)[:, 8:-24].any(axis=1))
    filled = filled[filled < len(part) - 3]
    return part[: filled[-1] + 2 * _GAP_PX] if filled.size else part


def sheet(parts: list[Pixels], strip: Pixels) -> Image.Image:
    """The parts in columns, each where least stands yet, and a strip below all of them."""
    columns: list[list[Pixels]] = [[] for _ in range(_COLUMNS)]
    for part in parts:
        lowest = min(columns, key=lambda column: sum(len(other) + _GAP_PX for other in column))
        lowest.append(part)
    height = max(sum(len(part) + _GAP_PX for part in column) for column in columns)
    width = _COLUMNS * (_WIDTH_PX + _GAP_PX) - _GAP_PX
    below = Image.fromarray(strip)
    below = below.resize((width, round(below.height * width / below.width)))
    whole = Image.new("RGB", (width, height + below.height), _BEHIND)
    whole.paste(below, (0, height))
    for n, column in enumerate(columns):
        top = 0
        for part in column:
            picture = Image.fromarray(part)
            if picture.width > _WIDTH_PX:
                shrunk = _WIDTH_PX, round(picture.height * _WIDTH_PX / picture.width)
                picture = picture.resize(shrunk, Image.Resampling.LANCZOS)
            whole.paste(picture, (n * (_WIDTH_PX + _GAP_PX), top))
            top += picture.height + _GAP_PX
    return whole


def later(posed: PosedWindow) -> None:
    """Move the clock by a minute, and wait."""
    clock = posed.session.last(ClockMoved)
    assert clock is not None
    posed.session.send(SetClock(instant=clock.instant + timedelta(minutes=1)))
    posed.rest()


def messages(posed: PosedWindow) -> Pixels:
    """The message inspector with what a move of the clock caused."""
    inspector = posed.window.panels["messages"]
    assert isinstance(inspector, MessageInspector)
    posed.window.show_dock("messages")
    posed.rest()
    later(posed)

    def moves_of_the_sun() -> list[int]:
        rows = inspector.table.messages.shown
        return [row.number for row in rows if row.type_name == "SunMoved"]

    posed.until(lambda: bool(moves_of_the_sun()))
    inspector.table.go_to(moves_of_the_sun()[-1])
    return posed.panel("messages")


def profiler(posed: PosedWindow) -> Pixels:
    """The overlay over the picture, while the day passes."""
    actions = posed.window.actions_by_name
    actions["profiler"].trigger()
    actions["play"].trigger()
    posed.until(lambda: len(posed.window.profiler.lines) > 12)
    found = seen(posed.window.profiler)
    actions["play"].trigger()
    actions["profiler"].trigger()
    return found


def dialogs(posed: PosedWindow) -> list[Pixels]:
    """The palette with a word in it, and the list of keys."""
    palette, keys = (
        posed.window.new_palette(),
        ShortcutList(posed.window.menus.specs, posed.window),
    )
    palette.text_field.setText("sun")
    found = []
    for dialog in (palette, keys):
        dialog.show()
        posed.rest()
        found.append(seen(dialog))
        dialog.close()
    return found


def all_parts(posed: PosedWindow) -> list[Pixels]:
    """Each panel, in the order of the sheet."""
    parts = [posed.panel(name) for name in ("place", "sun", "picture", "export")]
    for sky in ("dynamic_skylight", "bruneton_sky"):
        posed.session.send(ChooseSlot(slot="sky", module=sky))
        posed.rest()
        parts.append(posed.panel("sky"))
    parts += [posed.panel(name) for name in posed.window.docks if name.startswith("module ")]
    posed.window.show_dock("compare")
    posed.rest()
    disc = posed.window.panels["compare"].findChildren(SkyDisc)[0]
    disc.pointed.emit(POINTED)
    # An atmosphere of twelve wavelengths is solved for it.
    for _ in range(4):
        posed.rest()
    parts += [posed.panel("compare"), posed.panel("modules"), messages(posed)]
    return [trimmed(part) for part in [*parts, profiler(posed), *dialogs(posed)]]


def windows(posed: PosedWindow) -> Iterator[tuple[str, Pixels]]:
    """The window as it is first seen, and at three more occasions, by name."""
    window = posed.window
    yield "street", seen(window)
    window.show_dock("compare")
    posed.finish()
    yield "compare", seen(window)
    window.docks["compare"].hide()
    window.show_dock("sun")
    window.actions_by_name["sun path"].trigger()
    posed.open(SUNDIAL)
    yield "sundial", seen(window)
    window.actions_by_name["sun path"].trigger()
    window.show_dock("picture")
    window.show_dock("module clouds")
    posed.open(PAVILION)
    # Clouds are made on a thread, and drawn when they are there.
    posed.until(lambda: posed.session.last(CloudsChanged) is not None)
    posed.finish()
    yield "pavilion", seen(window)


def main() -> None:
    """Write all pictures."""
    folder = Path(sys.argv[1])
    app = QApplication([])
    apply_theme(app)
    with tempfile.TemporaryDirectory() as presets:
        posed = PosedWindow(app, Path(presets))
        try:
            for name, picture in windows(posed):
                Image.fromarray(picture).save(folder / f"app_{name}.jpg", quality=90)
            posed.window.resize(*LARGE)
            posed.open(STREET)
            parts = all_parts(posed)
            whole = sheet(parts, posed.panel("time"))
            whole.save(folder / "app_panels.jpg", quality=88)
        finally:
            posed.window.close()
            posed.session.join()


if __name__ == "__main__":
    main()

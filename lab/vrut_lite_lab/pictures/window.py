"""Pictures of the desktop application: the window with some scenes, a day, and every panel.

    xvfb-run -a -s "-screen 0 1920x1200x24" \\
        python -m vrut_lite_lab.pictures.window FOLDER [NAME ...]

Writes app_NAME.jpg of street, compare, traced, sundial, pavilion and panels, and the film
app_day.webp, or those that are named.
"""

import argparse
import os
import tempfile
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from path_tracer.panel import TracedPanel
from PIL import Image
from PySide6.QtWidgets import QApplication

from vrut_lite.app.compare.compare_panel import ComparePanel
from vrut_lite.app.theme import apply_theme
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.messages.clouds import CloudsChanged
from vrut_lite.project import CameraView
from vrut_lite_lab.pictures.drawing import scene_project
from vrut_lite_lab.pictures.posed_window import SIZE, PosedWindow, seen
from vrut_lite_lab.pictures.window_panels import all_parts, sheet

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
# From 45 minutes before sunrise to 45 after sunset in Prague.
DAY = scene_project("pavilion.gltf", at="2026-06-21T04:07")
_DAY_LASTS, _FRAMES, _FRAME_MS = timedelta(hours=17, minutes=53), 18, 333
# Where docks are to be seen whole; of the film as it is drawn, and as it is kept.
_LARGE, _FILM_DRAWN, _FILM = (1600, 1000), (1064, 700), (760, 500)
_TRACED_PATHS, _SHOWN_PATHS = 32, 16


def street(posed: PosedWindow) -> Image.Image:
    """The window as it is first seen."""
    posed.open(STREET)
    return Image.fromarray(seen(posed.window))


def compare(posed: PosedWindow) -> Image.Image:
    """Two skies beside the picture."""
    posed.open(STREET)
    panel = posed.window.panels["compare"]
    assert isinstance(panel, ComparePanel)
    posed.window.show_dock("compare")
    posed.until(lambda: panel.plots is not None)
    posed.finish()
    picture = Image.fromarray(seen(posed.window))
    posed.window.docks["compare"].hide()
    return picture


def traced(posed: PosedWindow) -> Image.Image:
    """The path-traced picture beside the frame."""
    posed.open(STREET)
    panel = posed.window.panels["panel path_tracer"]
    assert isinstance(panel, TracedPanel)
    posed.session.send(SetSetting(module="path_tracer", name="spp", value=_TRACED_PATHS))
    posed.window.show_dock("panel path_tracer")
    posed.finish()
    posed.until(lambda: panel.shown is not None and panel.shown.samples >= _SHOWN_PATHS)
    posed.rest()
    picture = Image.fromarray(seen(posed.window))
    posed.window.docks["panel path_tracer"].hide()
    return picture


def sundial(posed: PosedWindow) -> Image.Image:
    """The sun's path over the dial."""
    posed.window.show_dock("sun")
    path = posed.window.actions_by_name["sun path"]
    path.trigger()
    posed.open(SUNDIAL)
    picture = Image.fromarray(seen(posed.window))
    path.trigger()
    return picture


def pavilion(posed: PosedWindow) -> Image.Image:
    """A pavilion under clouds."""
    posed.window.show_dock("picture")
    posed.window.show_dock("module clouds")
    posed.open(PAVILION)

    # Clouds are made on a thread, and drawn when they are there.
    def has_clouds() -> bool:
        told = posed.session.last(CloudsChanged)
        return told is not None and bool(told.layers)

    posed.until(has_clouds)
    posed.finish(anew=True)
    return Image.fromarray(seen(posed.window))


def panels(posed: PosedWindow) -> Image.Image:
    """Every panel."""
    posed.window.resize(*_LARGE)
    posed.open(STREET)
    parts = all_parts(posed)
    whole = sheet(parts, posed.panel("time"))
    posed.window.resize(*SIZE)
    return whole


def day(posed: PosedWindow) -> list[Image.Image]:
    """A day over the pavilion, without panels but the time's."""
    posed.window.resize(*_FILM_DRAWN)
    for name, dock in posed.window.docks.items():
        if name != "time":
            dock.hide()
    posed.open(DAY)
    frames = []
    for number in range(_FRAMES):
        posed.move_to(DAY.instant() + number / (_FRAMES - 1) * _DAY_LASTS)
        frames.append(Image.fromarray(seen(posed.window)).resize(_FILM, Image.Resampling.LANCZOS))
    return frames


PICTURES: dict[str, Callable[[PosedWindow], Image.Image]] = {
    "street": street, "compare": compare, "traced": traced, "sundial": sundial,
    "pavilion": pavilion, "panels": panels,
}  # fmt: skip
FILM = "day"


def write(posed: PosedWindow, name: str, folder: Path) -> None:
    """Draw and save one."""
    if name != FILM:
        PICTURES[name](posed).save(folder / f"app_{name}.jpg", quality=89)
        return
    first, *others = day(posed)
    path = folder / f"app_{name}.webp"
    first.save(
        path, save_all=True, append_images=others, duration=_FRAME_MS, loop=0, quality=80, method=6
    )


def main() -> None:
    """Write all pictures, or those that are named."""
    names = [*PICTURES, FILM]
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", default=names, help=f"of {', '.join(names)}")
    chosen = parser.parse_args()
    app = QApplication([])
    apply_theme(app)
    with tempfile.TemporaryDirectory() as presets:
        posed = PosedWindow(app, Path(presets), STREET)
        try:
            for name in chosen.names:
                write(posed, name, chosen.folder)
        finally:
            posed.window.close()
            posed.session.join()


if __name__ == "__main__":
    main()

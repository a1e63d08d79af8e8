"""The acts of a tour: every panel, four scenes by day and night, clouds, both skies, exports."""

from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from PySide6.QtWidgets import QPushButton

from vrut_lite.app.compare.sky_disc import SkyDisc
from vrut_lite.app.window.shortcut_list import ShortcutList
from vrut_lite.kernel.messages import ChooseSlot, SetSetting
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.place import SetPlace
from vrut_lite.project import Project, load_project
from vrut_lite_lab.checkout import ROOT
from vrut_lite_lab.memory_tour.toured_window import TouredWindow

Act = tuple[str, Callable[[TouredWindow], None]]
_SCENES = ROOT / "scenes"
SCENES = ("street.toml", "work/indoor.glb", "pavilion.gltf", "large/terrain.toml")
# Opened in turn: a small one, and a mid-size one.
ALTERNATING = ("sundial.toml", "street.toml")
_HOURS = (16.6, 21.5)
_EXPORT_PX = (960, 540)
_TRACED_PATHS, _TRACED_LIMIT_S, _MEASURED_LIMIT_S = 2, 60.0, 60.0
_POINTED = (0.0, 0.7071, -0.7071)
_SKIES = ("bruneton_sky", "dynamic_skylight")


def project_of(scene: str) -> Project:
    """A scene of the repository as a project."""
    path = _SCENES / scene
    return load_project(path) if path.suffix == ".toml" else Project(scene=str(path))


def _at(hour_utc: float) -> datetime:
    whole = int(hour_utc)
    return datetime(2026, 6, 21, whole, round(60.0 * (hour_utc - whole)), tzinfo=UTC)


def tour() -> Iterator[Act]:
    """The acts of one tour, each with its name."""
    for scene in SCENES:
        yield from _in_scene(scene)
    yield "street", lambda toured: toured.open(project_of("street.toml"))
    yield "panels", _panels
    yield "compare", _compare
    yield "daylight", _daylight
    yield "path traced", _traced
    yield "messages", _messages
    yield "dialogs", _dialogs
    yield "undo", _undo


def _in_scene(scene: str) -> Iterator[Act]:
    name = Path(scene).stem
    yield name, lambda toured: toured.open(project_of(scene))
    for hour in _HOURS:
        yield f"{name} {hour:g} h", partial(_hour, hour=hour)
    yield f"{name} clouds", _clouds
    for sky in _SKIES:
        yield f"{name} {sky}", partial(_sky, sky=sky)
    yield f"{name} hand", _hand
    yield f"{name} sizes", _sizes
    yield f"{name} export", _export


def _hour(toured: TouredWindow, hour: float) -> None:
    toured.hour(_at(hour))


def _sky(toured: TouredWindow, sky: str) -> None:
    toured.send(ChooseSlot(slot="sky", module=sky))
    toured.send(SetHaze(optical_depth_550=0.3 if sky == _SKIES[0] else 0.12))


def _clouds(toured: TouredWindow) -> None:
    toured.send(SetSetting(module="clouds", name="coverage", value=0.4))
    toured.hour(_at(10.0))
    toured.send(SetSetting(module="clouds", name="coverage", value=0.0))


def _hand(toured: TouredWindow) -> None:
    """A drag in the picture, clicks there, on the map and on the day, and some playing time."""
    window = toured.window
    view = window.desk.viewport
    toured.drag(view, *[(0.3 + 0.03 * step, 0.5) for step in range(12)])
    toured.settle()
    for x, y in ((0.3, 0.7), (0.6, 0.8), (0.5, 0.3)):
        toured.click(view, x, y)
        toured.wait(0.1)
    window.show_dock("place")
    toured.click(toured.panel("place").map, 0.8, 0.6)
    toured.settle()
    toured.send(SetPlace(latitude_deg=50.0755, longitude_deg=14.4378))
    bar = window.time.bar
    toured.drag(bar, *[(0.3 + 0.03 * step, 0.5) for step in range(12)])
    toured.settle()
    toured.trigger("play")
    toured.wait(2.0)
    toured.trigger("play")
    toured.settle()


def _sizes(toured: TouredWindow) -> None:
    window = toured.window
    size = window.size()
    for share in (0.9, 1.05):
        window.resize(round(share * size.width()), round(share * size.height()))
        toured.settle()
    window.resize(size)
    toured.settle()


def _export(toured: TouredWindow) -> None:
    panel = toured.panel("export")
    chooser = panel.chosen_size
    for name in ("picture.png", "picture.exr", "picture.jpg"):
        chooser.choose(*_EXPORT_PX)
        panel.export(str(toured.folder / name))
        toured.until(lambda: "EV100" in panel.status.text())
    chooser.usual.setCurrentIndex(0)
    toured.settle()
    toured.window.files.pictures = toured.folder / "screenshots"
    toured.trigger("screenshot")


def _panels(toured: TouredWindow) -> None:
    window = toured.window
    for name, dock in window.docks.items():
        was_hidden = dock.isHidden()
        window.show_dock(name)
        toured.wait(0.3)
        if was_hidden:
            dock.hide()
    for action in ("sun path", "compass", "profiler"):
        toured.trigger(action)
    toured.wait(1.5)
    for action in ("sun path", "compass", "profiler"):
        toured.trigger(action)
    toured.trigger("section")
    toured.settle()
    toured.trigger("section")
    toured.settle()
    for shown in ("illuminance", "texels", "noise", "picture"):
        toured.trigger(f"show {shown}")
        toured.settle()


def _compare(toured: TouredWindow) -> None:
    panel = toured.panel("compare")
    seen: list[object] = []
    panel.comparison.spectra_seen.connect(seen.append)
    toured.window.show_dock("compare")
    toured.until(lambda: panel.plots is not None, 60.0)
    panel.findChildren(SkyDisc)[0].pointed.emit(_POINTED)
    toured.until(lambda: bool(seen), 60.0)
    toured.hour(_at(9.0))
    toured.wait(2.0)
    panel.comparison.spectra_seen.disconnect(seen.append)
    toured.window.docks["compare"].hide()
    toured.settle()


def _daylight(toured: TouredWindow) -> None:
    panel = toured.panel("panel light_transport.daylight")
    toured.window.show_dock("panel light_transport.daylight")
    toured.settle()
    panel.start()
    toured.until(lambda: panel.measured is not None, _MEASURED_LIMIT_S)
    toured.hour(_at(13.0))
    toured.wait(2.0)
    toured.window.docks["panel light_transport.daylight"].hide()


def _traced(toured: TouredWindow) -> None:
    panel = toured.panel("panel path_tracer")
    toured.send(SetSetting(module="path_tracer", name="spp", value=_TRACED_PATHS))
    for hour in (12.0, 15.0):
        toured.hour(_at(hour))
        toured.window.show_dock("panel path_tracer")
        toured.until(
            lambda: panel.shown is not None and panel.shown.samples >= _TRACED_PATHS,
            _TRACED_LIMIT_S,
        )
        toured.window.docks["panel path_tracer"].hide()
    toured.settle()


def _messages(toured: TouredWindow) -> None:
    """The message inspector while time plays."""
    toured.window.show_dock("messages")
    toured.trigger("play")
    toured.wait(4.0)
    toured.trigger("play")
    inspector = toured.panel("messages")
    rows = inspector.table.messages.shown
    if rows:
        inspector.table.go_to(rows[-1].number)
    for button in inspector.findChildren(QPushButton):
        if button.text() == "Clear":
            button.click()
    toured.window.docks["messages"].hide()
    toured.settle()


def _dialogs(toured: TouredWindow) -> None:
    for _ in range(3):
        palette = toured.window.new_palette()
        keys = ShortcutList(toured.window.menus.specs, toured.window)
        for dialog in (palette, keys):
            dialog.show()
            toured.wait(0.1)
            dialog.close()


def _undo(toured: TouredWindow) -> None:
    for action in ("undo", "undo", "undo", "redo", "redo", "redo"):
        toured.trigger(action)
        toured.wait(0.5)
    toured.settle()

"""The window: how soon a picture follows a slider, how long its event loop is held up, and how fast
pictures follow each other while time plays.

It runs in a process of its own (`window_process`), which has Qt and its OpenGL contexts to itself.
"""

import os
from importlib.util import find_spec

from vrut_lite_lab.bench.bench_path import BenchPath, Group
from vrut_lite_lab.bench.gl import missing_gl
from vrut_lite_lab.bench.own_process import figures_of, measured_path

RENDERERS, SKIES = ("OpenGL", "CPU"), ("dynamic_skylight", "bruneton_sky")
# Handlers of the kernel, in which sky, light and air are made; the frame; the viewport's paint
# event; and everything from the slider's signal to the end of that event.
PARTS = ("kernel", "draw", "paint", "whole")
# What goes on meanwhile; of a gap, all of it, what lies outside drawing, the window's own CPU time.
ACTS = ("nothing", "atmosphere solved anew", "scene loaded", "clouds made", "module sleeps 0.4 s")
GAPS = ("longest gap", "outside drawing", "own work")
# Pictures while the camera turns and while time plays: from one to the next, CPU of all threads
# for one, and how long it is drawn. The process also says the mean share of the window's width.
PACE_SCENES, PACES = ("street.toml", "pavilion.gltf"), ("orbiting", "time playing")
PACE_PARTS = ("picture", "CPU", "drawing")
_LATENCY = tuple(
    f"{renderer}, {sky}: {part}" for renderer in RENDERERS for sky in SKIES for part in PARTS
)
_GAPS = tuple(f"{act}: {gap}" for act in ACTS for gap in GAPS)
_PACE = tuple(
    f"{scene.partition('.')[0]}, {pace}: {part}"
    for scene in PACE_SCENES
    for pace in PACES
    for part in PACE_PARTS
)
_UNITS = {
    "window-latency": "a move of the slider",
    "window-gaps": "the longest gap",
    "window-pace": "from one to the next, mean",
}
# Seconds that a process has measured and no path has used yet.
_measured: dict[str, float] = {}


def groups(quick: bool) -> list[Group]:
    """Latency and gaps; the quick form leaves them out, as they take a minute."""
    reason = "takes a minute, which the quick form has not" if quick else missing_gl()
    if find_spec("PySide6") is None:
        reason = "PySide6 is not installed (the extra `app`)"
    left_out = {"the window": reason} if reason else {}
    return [
        _group("window-latency", "From the turbidity's slider to the picture", _LATENCY, left_out),
        _group("window-gaps", "Gaps of the window's event loop", _GAPS, left_out),
        _group("window-pace", "Pictures while something moves", _PACE, left_out),
    ]


def _group(name: str, title: str, paths: tuple[str, ...], left_out: dict[str, str]) -> Group:
    return Group(
        name=name,
        title=title,
        unit=_UNITS[name],
        norm="none: times alone",
        truth="none",
        paths=() if left_out else tuple(_path(name, each) for each in paths),
        left_out=left_out,
    )


def _path(group: str, name: str) -> BenchPath:
    def seconds() -> float:
        if name not in _measured:
            _measured.update(_measure(group))
        return _measured.pop(name)

    clock = "wall time, or CPU time of the window's thread for its own work"
    return measured_path(name, name.partition(":")[0], "window", clock, seconds)


def _measure(group: str) -> dict[str, float]:
    """Seconds of a group's paths, by a new process; ModuleFailed as `figures_of`."""
    platform = os.environ.get("QT_QPA_PLATFORM", "offscreen")
    return figures_of(
        "the window", "vrut_lite_lab.bench.paths.window_process", group, QT_QPA_PLATFORM=platform
    )

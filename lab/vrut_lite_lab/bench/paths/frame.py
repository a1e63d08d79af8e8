"""The frame with OpenGL: whole, and pass by pass; a frame has no error.

Every pass is done in every frame, also what a frame would skip: shadow maps and reflection are
those of a sky that has just changed. On a GPU passes are timed by timer query, on llvmpipe by the
CPU time of all threads until the pass is finished. Air and light shafts have no pass of their own:
the passes that draw are timed with them and without. A "film frame" skips all that may be skipped,
from a camera that stands still.
"""

from collections.abc import Callable
from dataclasses import fields
from datetime import timedelta
from functools import lru_cache
from itertools import cycle
from typing import Any

import msgspec

from vrut_lite import compiled_code
from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetClock, SetSetting
from vrut_lite.pictures.picture import Picture
from vrut_lite.project import Project, daylight_inputs, load_project, setting_inputs, view_inputs
from vrut_lite.render.picture_passes import unmeasured
from vrut_lite.scene.scene_state import FrameSkips
from vrut_lite_lab.bench.bench_path import (
    CPU_TIME,
    WALL_TIME,
    BenchPath,
    Group,
    Spent,
    Work,
    WorkClock,
    cpu_spent,
)
from vrut_lite_lab.bench.gl import (
    PassTimer,
    clock_name,
    close_gl,
    has_timer,
    missing_gl,
    on_close,
    renderer,
)
from vrut_lite_lab.checkout import ROOT

SCENES = ROOT / "scenes"
PAVILION, VALLEY = "pavilion.gltf", "large/terrain.toml"
NOTHING = FrameSkips(**{field.name: False for field in fields(FrameSkips)})
SIZES, QUICK_SIZES, VALLEY_SIZE = ((320, 200), (960, 600)), ((320, 200),), (480, 270)
# Passes in which air is drawn, and all passes.
DRAWING = ("mesh", "sky", "blended mesh")
PASSES = (*DRAWING, "shadow", "reflection", "resolve", "tone map", "copy and meter")
Size = tuple[int, int]
# Module, name and value of settings.
Settings = tuple[tuple[str, str, Any], ...]
_AIR: Settings = (("scene", "air", True),)
_NO_AIR: Settings = (("scene", "air", False),)


def _in_valley(fog_m: float | None = None, shafts: bool = False, cover: float = 0.0) -> Settings:
    return (
        *_AIR,
        ("bruneton_sky", "fog_visibility_m", fog_m),
        ("scene", "light_shafts", shafts),
        ("clouds", "coverage", cover),
    )


# The passes of frame parts: clouds cast shadows before surfaces are drawn, and lie over them.
PREPARED, OVER = "parts before surfaces", "parts over surfaces"
# Settings of the valley, and the passes that are theirs.
_SOLID, _CLOUDY = ("shadow", "mesh", "sky"), (PREPARED, OVER, "mesh", "sky")
CASES: dict[str, tuple[Settings, tuple[str, ...]]] = {
    "no air": ((*_in_valley(), *_NO_AIR), _SOLID),
    "air": (_in_valley(), _SOLID),
    "air, fog": (_in_valley(fog_m=1000.0), _SOLID),
    "air, shafts": (_in_valley(shafts=True), _SOLID),
    "air, clouds 0.5": (_in_valley(cover=0.5), _CLOUDY),
    "air, shafts, clouds 0.5": (_in_valley(shafts=True, cover=0.5), _CLOUDY),
}


def groups(quick: bool) -> list[Group]:
    """The pavilion; in the full form also a valley in different air."""
    made = [_group("frame", PAVILION, _pavilion_paths, QUICK_SIZES if quick else SIZES)]
    return made if quick else [*made, _group("frame-valley", VALLEY, _valley_paths, (VALLEY_SIZE,))]


def _group(
    name: str, scene: str, paths: Callable[[Size], list[BenchPath]], sizes: tuple[Size, ...]
) -> Group:
    reason = missing_gl() or ("" if (SCENES / scene).exists() else f"there is no {scene}")
    return Group(
        name=name,
        title=f"A frame of {scene}, by pass",
        unit="a frame",
        norm="none: a frame has no twin",
        truth="none",
        paths=() if reason else tuple(path for size in sizes for path in paths(size)),
        left_out={name: reason} if reason else {},
    )


class FrameStage:
    """A host with a scene open, in pictures of a size."""

    def __init__(self, scene: str, size: Size):
        project = _project(scene, size)
        self.host = Host()
        self.host.inject(*setting_inputs(project, self.host.kernel), *daylight_inputs(project))
        self.host.inject(*view_inputs(project))
        self.host.draw()
        # In the valley the sun moves to and fro, so that clouds' shadows are drawn in every frame.
        self._hours = cycle(project.instant() + timedelta(minutes=m) for m in _minutes(scene))
        self._timed: dict[tuple[Settings, str], list[Spent]] = {}
        self._timer = self.host.gl.call(PassTimer)

    def next_pass(self, name: str, settings: Settings) -> Spent:
        """A pass that was timed in an earlier frame and not yet used; else one of a new frame."""
        while not self._timed.get((settings, name)):
            self._set(settings)
            self.host.inject(SetClock(instant=next(self._hours)))
            self.host.measure_passes(self._timer)
            self._timer.spent.clear()
            compiled = compiled_code.compilations
            whole = cpu_spent(self._frame)
            self.host.measure_passes(unmeasured)
            if compiled_code.compilations > compiled:
                continue
            for each, seconds in self._timer.spent.items():
                spent = Spent(None, seconds, whole.wall_s)
                self._timed.setdefault((settings, each), []).append(spent)
        return self._timed[settings, name].pop()

    def frame(self) -> Picture:
        """A frame with air in which nothing is skipped."""
        self._set(_AIR)
        return self._frame()

    def film_frame(self) -> Picture:
        """A frame with air in which all is skipped that may be."""
        self._set(_AIR)
        self.host.frame_skips = FrameSkips()
        return self.host.draw(still=False)

    @property
    def pictures(self) -> int:
        """Number of pictures drawn so far, moving or still."""
        return self.host.frame_counters.done["picture"]

    def _frame(self) -> Picture:
        self.host.frame_skips = NOTHING
        return self.host.draw()

    def _set(self, settings: Settings) -> None:
        self.host.inject(*(SetSetting(module=m, name=n, value=v) for m, n, v in settings))


def _minutes(scene: str) -> tuple[int, ...]:
    return (0, 10) if scene == VALLEY else (0,)


def _project(scene: str, size: Size) -> Project:
    if scene == PAVILION:
        return Project(scene=str(SCENES / scene), at="2026-06-21T11:00", size=size)
    project, sky = load_project(SCENES / scene), {"sky": "bruneton_sky"}
    return msgspec.structs.replace(project, size=size, slots=sky, at="2026-06-28T13:00")


@lru_cache(maxsize=1)
def stage(scene: str, size: Size) -> FrameStage:
    """The stage of a scene and size. There is one at a time, and no other OpenGL context."""
    close_gl()
    made = FrameStage(scene, size)
    on_close(stage.cache_clear)
    on_close(made.host.close)
    return made


def _pavilion_paths(size: Size) -> list[BenchPath]:
    whole = WALL_TIME if has_timer(renderer()) else CPU_TIME
    paths = [
        _path(size, name, prepare, whole, done=lambda _work: stage(PAVILION, size).pictures)
        for name, prepare in (
            ("whole frame", lambda: stage(PAVILION, size).frame),
            ("film frame", lambda: stage(PAVILION, size).film_frame),
        )
    ]
    paths += [_pass_path(PAVILION, size, name, name, _AIR) for name in PASSES]
    return paths + [
        _pass_path(PAVILION, size, f"{name}, without air", name, _NO_AIR) for name in DRAWING
    ]


def _valley_paths(size: Size) -> list[BenchPath]:
    return [
        _pass_path(VALLEY, size, f"{case}: {name}", name, settings)
        for case, (settings, passes) in CASES.items()
        for name in passes
    ]


def _pass_path(scene: str, size: Size, said: str, name: str, settings: Settings) -> BenchPath:
    def spent(_work: Work) -> Spent:
        """One of a frame's passes; a frame serves all its passes, each once."""
        return stage(scene, size).next_pass(name, settings)

    clock = WorkClock(clock_name(renderer()), spent)
    return _path(size, said, lambda: lambda: None, clock)


def _path(
    size: Size,
    name: str,
    prepare: Callable[[], Work],
    clock: WorkClock,
    done: Callable[[Work], int] | None = None,
) -> BenchPath:
    width, height = size
    return BenchPath(
        name=f"{name}, {width} x {height}",
        family=name,
        parameters={"width": width, "height": height},
        prepare=prepare,
        error=None,
        batch=f"{width} {name.partition(':')[0] if ':' in name else ''}",
        clock=clock,
        device="GPU",
        done=done,
    )

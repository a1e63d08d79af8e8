"""The frame on whatever OpenGL there is: whole, and pass by pass; it has no twin to err from.

Every pass is done in every frame, also what a frame would skip: shadow map and reflection are
those of a sky that has just changed. On a GPU passes are timed by timer query; llvmpipe's does not
see compute shaders, so there it is the CPU time of all threads until the pass is finished. Air has
no pass of its own: the passes that draw are timed with it and without. A "film frame" skips all
that may be, from a camera that stands still.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from functools import lru_cache, partial
from pathlib import Path as FilePath

from vrut_lite.daylight.scene_state import FrameSkips
from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.pictures.picture import Picture
from vrut_lite.project import Project, daylight_inputs, view_inputs
from vrut_lite_bench.gl import close_gl, missing_gl, on_close, renderer
from vrut_lite_bench.gpu_clock import clock_name, has_timer
from vrut_lite_bench.pass_timer import PassTimer
from vrut_lite_bench.path import (
    CPU_TIME,
    WALL_TIME,
    Clock,
    Group,
    Path,
    Spent,
    Work,
    cpu_spent,
)
from vrut_lite_bench.work_skipped import NOTHING

SCENE = FilePath(__file__).resolve().parents[3] / "scenes" / "pavilion.gltf"
SIZES, QUICK_SIZES = ((320, 200), (960, 600)), ((320, 200),)
# Those in which air is drawn, and all others but the whole.
DRAWING = ("mesh", "sky", "blended mesh")
PASSES = (*DRAWING, "shadow", "reflection", "resolve", "tone map", "copy and meter")
Size = tuple[int, int]


def groups(quick: bool) -> list[Group]:
    """The one group."""
    sizes, left_out = QUICK_SIZES if quick else SIZES, {}
    if reason := missing_gl() or ("" if SCENE.exists() else f"there is no {SCENE.name}"):
        left_out["frames"] = reason
    return [
        Group(
            name="frame",
            title=f"A frame of {SCENE.name}, by pass",
            unit="a frame",
            norm="none: a frame has no twin",
            truth="none",
            paths=() if left_out else tuple(path for size in sizes for path in _paths(size)),
            left_out=left_out,
        )
    ]


class Stage:
    """A host with the scene at eleven in the morning, in pictures of a size."""

    def __init__(self, size: Size):
        project = Project(scene=str(SCENE), at="2026-06-21T11:00", size=size)
        self.host = Host()
        self.host.inject(*daylight_inputs(project), *view_inputs(project))
        self.host.draw()
        by_query = has_timer(self.host.gl.renderer)
        self._timed: dict[bool, dict[str, list[Spent]]] = {False: {}, True: {}}
        self._timer = self.host.gl.call(lambda context: PassTimer(context, by_query))

    def next_pass(self, name: str, air: bool) -> Spent:
        """A pass that has been timed and not yet told; else of a frame that is drawn now."""
        waiting = self._timed[air]
        if not waiting.get(name):
            self.host.inject(SetSetting(module="scene", name="air", value=air))
            self.host.measure_passes(self._timer)
            whole = cpu_spent(self._frame)
            self.host.measure_passes(_untimed)
            for each, seconds in self._timer.spent.items():
                waiting.setdefault(each, []).append(Spent(None, seconds, whole.wall_s))
        return waiting[name].pop()

    def frame(self) -> Picture:
        """A frame with air in which nothing is skipped."""
        self.host.inject(SetSetting(module="scene", name="air", value=True))
        return self._frame()

    def _frame(self) -> Picture:
        self.host.frame_skips = NOTHING
        return self.host.draw()

    def film_frame(self) -> Picture:
        """A frame in which all is skipped that may be."""
        self.host.inject(SetSetting(module="scene", name="air", value=True))
        self.host.frame_skips = FrameSkips()
        return self.host.draw(still=False)


def _untimed(_name: str) -> AbstractContextManager[None]:
    return nullcontext()


@lru_cache(maxsize=1)
def stage(size: Size) -> Stage:
    """The stage of a size. There is one at a time, and no other context of OpenGL beside it."""
    close_gl()
    made = Stage(size)
    on_close(stage.cache_clear)
    on_close(made.host.close)
    return made


def _paths(size: Size) -> list[Path]:
    by_query = has_timer(renderer())
    whole = WALL_TIME if by_query else CPU_TIME
    paths = [
        _path(size, "whole frame", lambda: stage(size).frame, whole),
        _path(size, "film frame", lambda: stage(size).film_frame, whole),
    ]
    paths += [_pass_path(size, name, True) for name in PASSES]
    return paths + [_pass_path(size, name, False) for name in DRAWING]


def _pass_path(size: Size, name: str, air: bool) -> Path:
    clock = Clock(clock_name(renderer()), partial(_pass_spent, size, name, air))
    said = name if air else f"{name}, without air"
    return _path(size, said, lambda: lambda: None, clock)


def _pass_spent(size: Size, name: str, air: bool, _work: Work) -> Spent:
    """One of a frame's passes; a frame serves all its passes, each once."""
    return stage(size).next_pass(name, air)


def _path(size: Size, name: str, prepare: Callable[[], Work], clock: Clock) -> Path:
    width, height = size
    return Path(
        name=f"{name}, {width} x {height}",
        family=name,
        parameters={"width": width, "height": height},
        prepare=prepare,
        error=None,
        batch=f"{width}",
        clock=clock,
        device="GPU",
    )

"""Time of a frame by pass, on whatever OpenGL there is.

    python -m vrut_lite_bench.frame [--size 1920x1080] [--scene SCENE] [--rounds N]

Every pass is done in every round, also what a frame would skip: shadow map and reflection are
those of a sky that has just changed. On a GPU passes are timed by timer query; llvmpipe's does
not see compute shaders, so there it is the CPU time of all its threads until the pass is
finished. Air has no pass of its own: "air" is by how much it lengthens those that draw, which
are timed with it. "whole frame" is what the caller waits for, the copy to the CPU and the
metering of the exposure included: on a GPU in wall time, on llvmpipe in CPU time. "film frame"
is the same with everything skipped that may be, from a camera that stands still.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple

from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.project import Project, daylight_inputs, view_inputs
from vrut_lite.render.skips import FrameSkips

SCENE = Path(__file__).resolve().parents[2] / "scenes" / "pavilion.gltf"
# The passes that run as compute shaders; all others draw.
COMPUTE = ("reflection",)
# Those in which air is drawn.
DRAWING = ("mesh", "sky", "blended mesh")
ROUNDS = 9


class FrameTimes(NamedTuple):
    """The renderer, how it was timed, and seconds by pass, each the least of the rounds."""

    renderer: str
    clock: str
    seconds: dict[str, float]


class PassTimer:
    """Collects the time of each pass; used on the GL thread."""

    def __init__(self, context: Any, by_query: bool):
        self._context = context
        self._by_query = by_query
        self.spent: dict[str, list[float]] = {}

    def __call__(self, name: str) -> AbstractContextManager[None]:
        """Time what is done inside."""
        return self._by_gpu(name) if self._by_query else self._by_cpu(name)

    @contextmanager
    def _by_gpu(self, name: str) -> Iterator[None]:
        query = self._context.query(time=True)
        with query:
            yield
        self._note(name, query.elapsed * 1e-9)

    @contextmanager
    def _by_cpu(self, name: str) -> Iterator[None]:
        self._context.finish()
        start = time.process_time()
        yield
        self._context.finish()
        self._note(name, time.process_time() - start)

    def _note(self, name: str, seconds: float) -> None:
        self.spent.setdefault(name, []).append(seconds)


def measure(scene: Path, size: tuple[int, int], rounds: int = ROUNDS) -> FrameTimes:
    """Times of a scene at eleven in the morning, in pictures of `size` (width, height)."""
    project = Project(scene=str(scene), at="2026-06-21T11:00", size=size)
    with Host() as host:
        host.inject(*daylight_inputs(project), *view_inputs(project))
        host.draw()
        by_query = "llvmpipe" not in host.gl.renderer
        clock = time.perf_counter if by_query else time.process_time
        film = min(_timed(clock, lambda: host.draw(still=False)) for _ in range(rounds))
        host.frame_skips = FrameSkips(**{field.name: False for field in fields(FrameSkips)})
        whole = min(_timed(clock, host.draw) for _ in range(rounds))
        timer = host.gl.call(lambda context: PassTimer(context, by_query))
        host.measure_passes(timer)
        for _ in range(rounds):
            host.draw()
        seconds = {name: min(spent) for name, spent in timer.spent.items()}
        timer.spent.clear()
        host.inject(SetSetting(module="scene", name="air", value=False))
        for _ in range(rounds):
            host.draw()
        seconds["air"] = sum(seconds[name] - min(timer.spent[name]) for name in DRAWING)
        name = "timer query" if by_query else "CPU time of all threads"
        ends = {"whole frame": whole, "film frame": film}
        return FrameTimes(host.gl.renderer.split(" (")[0], name, seconds | ends)


def _timed(clock: Callable[[], float], work: Callable[[], Any]) -> float:
    start = clock()
    work()
    return clock() - start


def report(scene: Path, size: tuple[int, int], rounds: int = ROUNDS) -> Iterator[str]:
    """The figures as lines of text, in milliseconds."""
    times = measure(scene, size, rounds)
    yield f"{times.renderer}, {times.clock}: {scene.name}, {size[0]} x {size[1]}"
    for name, seconds in times.seconds.items():
        kind = " (compute)" if name in COMPUTE else ""
        yield f"  {name + kind:24s} {seconds * 1e3:9.3f} ms"


def main() -> None:
    """Print the report."""
    parser = argparse.ArgumentParser(description="Time of a frame by pass.")
    parser.add_argument("--size", default="640x400", help="WIDTHxHEIGHT in pixels")
    parser.add_argument("--scene", type=Path, default=SCENE, help="glTF, GLB or OBJ")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    options = parser.parse_args()
    width, _, height = options.size.partition("x")
    for line in report(options.scene, (int(width), int(height)), options.rounds):
        print(line)


if __name__ == "__main__":
    main()

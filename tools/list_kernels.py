"""Writes the lists of kernels that packages announce: `data/kernels.json` of each.

    python -m tools.list_kernels

A process with empty caches draws pictures as `vrut-lite render` does, another as the window does
while it moves. What they compile is listed in order of need, with the CPU time that it took. Run
it after a change of a kernel's name or arguments; a test compares the lists with what is called.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec

from vrut_lite import compiled_code
from vrut_lite.compiling import ahead
from vrut_lite.compiling.kernel_list import KernelGroup, ListedKernel, kernel_of, list_file
from vrut_lite.project import Project
from vrut_lite.scene.scene_state import FrameSkips
from vrut_lite.studio.scene_pictures import ScenePlan

SCENES = Path(__file__).resolve().parents[1] / "scenes"
# It has textures, a lamp, a part that mirrors, and a room in which light goes to and fro.
DRAWN = ("work/indoor.glb",)
SIZE = (96, 60)
WAYS = ("picture", "window")
TITLES = {
    "vrut_lite": "pictures",
    "dynamic_skylight": "the sky",
    "light_transport": "light between surfaces",
}
_AT = "2026-06-21T12:00"
# The kernels of the default tolerance with a third less work.
_TOLERANCE = 0.3


def rehearse(way: str) -> None:
    """Draw as `vrut-lite render` does, or as the window does too; print each kernel called."""
    order: dict[tuple[str, str, str], ListedKernel] = {}
    seconds: dict[tuple[str, str, str], float] = {}

    def note(dispatcher: Any, arguments: Any) -> None:
        kernel = kernel_of(dispatcher, arguments)
        if kernel is not None:
            order.setdefault(kernel.key, kernel)

    compiled_code.before_kernel.append(note)
    # Each is compiled here.
    ahead.LEAST_SECONDS = math.inf
    _time_compilations(seconds)
    for scene in DRAWN:
        draw(str(SCENES / scene), moves=way == "window")
    for key, kernel in order.items():
        # What was on disk has no time.
        spent = round(seconds.get(key, 0.0), 2)
        print(msgspec.json.encode(msgspec.structs.replace(kernel, seconds=spent)).decode())


def draw(scene: str, moves: bool) -> None:
    """A finished picture of a scene; after it, if it moves, pictures of the turning camera."""
    plan = ScenePlan(Project(scene=scene, at=_AT, size=SIZE, tolerance=_TOLERANCE))
    studio = plan.open()
    try:
        studio.shoot(plan.project.instant())
        if moves:
            # Light is on: dark pictures take another tone pass.
            _move(studio.host)
    finally:
        studio.close()


def _move(host: Any) -> None:
    """Pictures as the window draws them while a hand turns the camera."""
    before, host.frame_skips = host.frame_skips, FrameSkips()
    for _ in range(3):
        host.draw(still=False)
    host.frame_skips = before


def _time_compilations(seconds: dict[tuple[str, str, str], float]) -> None:
    from numba.core import event

    class Timer(event.Listener):
        def __init__(self) -> None:
            self.starts_s: list[float] = []

        def on_start(self, event: Any) -> None:
            self.starts_s.append(time.thread_time())

        def on_end(self, event: Any) -> None:
            spent_s = time.thread_time() - self.starts_s.pop()
            kernel = kernel_of(event.data["dispatcher"], event.data["args"])
            if not self.starts_s and kernel is not None:
                seconds[kernel.key] = spent_s

    # numba compiles under a lock, so that one list serves all threads.
    event.register("numba:compile", Timer())


def kernels_of(way: str, compiled: Path | None = None) -> list[ListedKernel]:
    """The kernels that a way calls, in order of need.

    Args:
        way: one of `WAYS`.
        compiled: the folder of compiled code instead of the user's. A kernel that is not there has
            its CPU time.
    """
    with tempfile.TemporaryDirectory() as empty:
        kernels = str(compiled or compiled_code.kernels_folder())
        environment = os.environ | {"XDG_CACHE_HOME": empty, "NUMBA_CACHE_DIR": kernels}
        found = subprocess.run(
            [sys.executable, "-m", "tools.list_kernels", way],
            cwd=SCENES.parent,
            stdout=subprocess.PIPE,
            env=environment,
            check=True,
        )
    lines = found.stdout.decode().splitlines()
    return [msgspec.json.decode(line, type=ListedKernel) for line in lines]


def groups_of(
    picture: Iterable[ListedKernel], window: Iterable[ListedKernel]
) -> dict[str, list[KernelGroup]]:
    """The groups of each package: what pictures need, and what the window needs besides."""
    by_package: dict[str, dict[bool, list[ListedKernel]]] = defaultdict(
        lambda: {False: [], True: []}
    )
    known = set()
    for alone, kernels in ((False, picture), (True, window)):
        for kernel in kernels:
            if kernel.key not in known:
                known.add(kernel.key)
                by_package[kernel.module.partition(".")[0]][alone].append(kernel)
    return {
        package: [
            KernelGroup(TITLES[package], tuple(kernels), window_alone=alone)
            for alone, kernels in both.items()
            if kernels
        ]
        for package, both in by_package.items()
    }


def write_lists() -> None:
    """Write the list of every package."""
    with tempfile.TemporaryDirectory() as folder:
        picture, window = (kernels_of(way, Path(folder)) for way in WAYS)
        # Kernels that another has compiled in the first round are called by themselves now.
        picture += kernels_of(WAYS[0], Path(folder))
    for package, groups in groups_of(picture, window).items():
        file = list_file(package)
        assert file is not None
        file.parent.mkdir(exist_ok=True)
        text = json.dumps(msgspec.to_builtins(groups), indent=1)
        file.write_text(text + "\n")
        print(f"{file}: {sum(len(group.kernels) for group in groups)} kernels")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        rehearse(sys.argv[1])
    else:
        write_lists()

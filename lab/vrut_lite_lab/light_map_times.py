"""The cost of the light map of each scene: first light, the whole bake, an hour, memory.

    python -m vrut_lite_lab.light_map_times [SCENE ...] [--quality usual] [--hours 5]

Each scene is opened in a kernel with a sky and without a window, its light demanded, and the bake
waited for; nothing is read from the cache of rays. Times count from the message that a scene is
open: "first light" until the first message of light, by the clock and as CPU time of all threads;
"map" until the first light of the map itself, for large scenes are lit by probes before; "bake"
until that of the last round. "hour" is a new one in the middle of the day, from the clock's message
to the light's, with the sky's own work in it: the least of some that are 20 minutes apart, and the
mean of some a minute apart. Kernels must have been compiled before: the first scene is played
twice.
"""

import argparse
import os
import tempfile
import time
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import NamedTuple

from light_transport.messages import NAME, BakeGrown
from light_transport.module import LightTransport

from vrut_lite import compiled_code
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, Message, SetClock, SetSetting
from vrut_lite.messages.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.scene.manager import SceneManager
from vrut_lite_lab.checkout import ROOT

SCENES = ROOT / "scenes"
USUAL = (
    "work/indoor.glb", "large/hall.glb", "street.obj", "pavilion.gltf", "spheres.glb",
    "sundial.glb", "large/terrain.glb",
)  # fmt: skip
_NOON = datetime(2026, 6, 21, 10, 30, tzinfo=UTC)


class TimeCosts(NamedTuple):
    """Of one scene; see the file's head."""

    texels: int
    size_px: tuple[int, int]
    triangles: int
    first_light_wall_s: float
    first_light_s: float
    map_s: float
    bake_s: float
    hour_s: float
    next_hour_s: float
    table_mb: float
    rays: int


class _Told(NamedTuple):
    """A message, by the clock and the CPU time at which it was posted."""

    message: Message
    wall_s: float
    cpu_s: float


def costs_of(scene: Path, quality: str | None, hours: int) -> TimeCosts:
    """Open a scene, and look at the clock."""
    kernel, _ = daylight_kernel()
    if NAME not in kernel.seats:
        kernel.add_module(LightTransport)
    kernel.add_module(SceneManager)
    kernel.inject(SetSetting(module=NAME, name="quality", value=quality))
    kernel.inject(SetPlace(latitude_deg=50.0, longitude_deg=14.0))
    kernel.inject(SetClock(instant=_NOON))
    kernel.inject(Demand(consumer="times", message=SurfaceLightChanged.__name__))
    kernel.pump_until_idle()
    told: list[_Told] = []
    kernel.tap(
        lambda message, _: told.append(_Told(message, time.perf_counter(), time.process_time()))
    )
    kernel.inject(LoadScene(path=str(scene)))
    kernel.pump_until_idle()
    opened = next(each for each in told if isinstance(each.message, SceneOpened))
    light = [each for each in told if isinstance(each.message, SurfaceLightChanged)]
    last = light[-1]
    of_map = next(each for each in light if _layout(each) == _layout(last))
    far = _hours_s(kernel, [_NOON + timedelta(minutes=20 * n) for n in range(1, hours + 1)])
    near = _hours_s(kernel, [_NOON - timedelta(minutes=60 - n) for n in range(4 * hours)])
    laid, grown = kernel.last(LightMapLaid), kernel.last(BakeGrown)
    scene_opened = kernel.last(SceneOpened)
    assert laid is not None
    assert grown is not None
    assert scene_opened is not None
    kernel.close()
    return TimeCosts(
        grown.texels,
        laid.size_px,
        scene_opened.triangles,
        light[0].wall_s - opened.wall_s,
        light[0].cpu_s - opened.cpu_s,
        of_map.cpu_s - opened.cpu_s,
        last.cpu_s - opened.cpu_s,
        min(far),
        # The first comes from afar.
        sum(near[1:]) / len(near[1:]),
        grown.table_bytes / 1e6,
        grown.rays,
    )


def _layout(told: _Told) -> str:
    assert isinstance(told.message, SurfaceLightChanged)
    return told.message.layout_key


def _hours_s(kernel: Kernel, instants: list[datetime]) -> list[float]:
    """CPU time of all threads for each."""
    spent = []
    for instant in instants:
        kernel.inject(SetClock(instant=instant))
        start = time.process_time()
        kernel.pump_until_idle()
        spent.append(time.process_time() - start)
    return spent


def main() -> None:
    """Print a Markdown table."""
    parser = argparse.ArgumentParser(description="What light maps cost.")
    parser.add_argument("scenes", nargs="*", default=USUAL)
    parser.add_argument("--quality", default=None)
    parser.add_argument("--hours", type=int, default=5)
    asked = parser.parse_args()
    print("| scene | triangles | texels | map | first light s | CPU s | map CPU s | bake CPU s "
          "| rays | hour CPU ms | next minute | MB |")  # fmt: skip
    print("|---|---:|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    compiled_code.share_kernels()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = str(Path(folder) / "compiled")
        costs_of(SCENES / asked.scenes[0], asked.quality, 1)
        for name in asked.scenes:
            os.environ["XDG_CACHE_HOME"] = str(Path(folder) / Path(name).stem)
            costs = costs_of(SCENES / name, asked.quality, asked.hours)
            width, height = costs.size_px
            print(
                f"| {Path(name).stem} | {costs.triangles:,} | {costs.texels:,} "
                f"| {width} x {height} | {costs.first_light_wall_s:.2f} "
                f"| {costs.first_light_s:.2f} | {costs.map_s:.2f} | {costs.bake_s:.2f} "
                f"| {costs.rays} | {1e3 * costs.hour_s:.0f} | {1e3 * costs.next_hour_s:.0f} "
                f"| {costs.table_mb:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()

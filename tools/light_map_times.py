"""The cost of the light map of each scene: first light, the whole bake, an hour, memory.

    python -m tools.light_map_times [SCENE ...] [--quality usual] [--hours 5]

Each scene is opened in a kernel with a sky and without a window, its light demanded, and the bake
waited for; nothing is read from the cache of rays. All times are CPU time of all threads: "layout"
until the layout is told, "first light" until the first message of light, "bake" until that of the
last round, "hour" that of a new hour in the middle of the day, the least of some. Kernels must have
been compiled before: the first scene is played twice.
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

from vrut_lite.daylight.daylight_kernel import daylight_kernel
from vrut_lite.daylight.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.scene import LoadScene, SceneOpened
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, Message, SetClock, SetSetting
from vrut_lite.scene.manager import SceneManager

SCENES = Path(__file__).resolve().parents[1] / "scenes"
USUAL = (
    "work/indoor.glb", "large/hall.glb", "street.obj", "pavilion.gltf", "spheres.glb",
    "sundial.glb", "large/terrain.glb",
)  # fmt: skip
_NOON = datetime(2026, 6, 21, 10, 30, tzinfo=UTC)


class Costs(NamedTuple):
    """Of one scene; see the file's head."""

    texels: int
    size_px: tuple[int, int]
    triangles: int
    layout_s: float
    first_light_s: float
    bake_s: float
    hour_s: float
    table_mb: float
    rays: int


class _Clock:
    """CPU times of a kernel's messages."""

    def __init__(self, kernel: Kernel):
        self.told: dict[type[Message], list[float]] = {}
        kernel.tap(self._note)

    def _note(self, message: Message, _sender: str) -> None:
        self.told.setdefault(type(message), []).append(time.process_time())


def costs_of(scene: Path, quality: str | None, hours: int) -> Costs:
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
    clock = _Clock(kernel)
    kernel.inject(LoadScene(path=str(scene)))
    kernel.pump_until_idle()
    opened, light = clock.told[SceneOpened][0], clock.told[SurfaceLightChanged]
    rounds = len(light)
    spent = []
    for hour in range(1, hours + 1):
        kernel.inject(SetClock(instant=_NOON + timedelta(minutes=20 * hour)))
        start = time.process_time()
        kernel.pump_until_idle()
        spent.append(time.process_time() - start)
    laid, grown = kernel.last(LightMapLaid), kernel.last(BakeGrown)
    scene_opened = kernel.last(SceneOpened)
    assert laid is not None
    assert grown is not None
    assert scene_opened is not None
    kernel.close()
    return Costs(
        grown.texels,
        laid.size_px,
        scene_opened.triangles,
        clock.told[LightMapLaid][0] - opened,
        light[0] - opened,
        light[rounds - 1] - opened,
        min(spent),
        grown.table_bytes / 1e6,
        grown.rays,
    )


def main() -> None:
    """Print a Markdown table."""
    parser = argparse.ArgumentParser(description="What light maps cost.")
    parser.add_argument("scenes", nargs="*", default=USUAL)
    parser.add_argument("--quality", default=None)
    parser.add_argument("--hours", type=int, default=5)
    asked = parser.parse_args()
    print("| scene | triangles | texels | map | layout s | first light s | bake CPU s | rays "
          "| hour CPU ms | MB |")  # fmt: skip
    print("|---|---:|---:|---|---:|---:|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = str(Path(folder) / "compiled")
        costs_of(SCENES / asked.scenes[0], asked.quality, 1)
        for name in asked.scenes:
            os.environ["XDG_CACHE_HOME"] = str(Path(folder) / Path(name).stem)
            costs = costs_of(SCENES / name, asked.quality, asked.hours)
            width, height = costs.size_px
            print(
                f"| {Path(name).stem} | {costs.triangles:,} | {costs.texels:,} "
                f"| {width} x {height} | {costs.layout_s:.2f} | {costs.first_light_s:.2f} "
                f"| {costs.bake_s:.2f} | {costs.rays} | {1e3 * costs.hour_s:.0f} "
                f"| {costs.table_mb:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()

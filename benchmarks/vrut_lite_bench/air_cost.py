"""What air, light shafts, fog and clouds cost a frame of the terrain, by pass, and their tables.

    python -m vrut_lite_bench.air_cost [WIDTHxHEIGHT]

Prints two Markdown tables in milliseconds, each the least of some rounds: passes of frames in
which shadow maps are drawn anew, and the tables that are filled on the CPU
when sun, eye or haze change, or what the CPU does for those that the GPU fills (their shader is
timed by vrut_lite_bench.bruneton_gpu). On llvmpipe it is CPU time of all threads.
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from bruneton_sky.air_volume import air_volume
from bruneton_sky.gpu_air import air_volume_job
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solver_job import solve_air
from dynamic_skylight.air import air_volume as exponential_air_volume
from dynamic_skylight.daylight import Daylight

from vrut_lite.daylight.scene_state import FrameSkips
from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.project import daylight_inputs, load_project, setting_inputs, view_inputs
from vrut_lite_bench.pass_timer import PassTimer

SCENE = Path(__file__).resolve().parents[2] / "scenes" / "large" / "terrain.toml"
PASSES = ("shadow", "mesh", "clouds", "sky", "blended mesh")
# Settings of the frames, each beside those before it.
CASES: dict[str, tuple[tuple[str, str, Any], ...]] = {
    "no air": (("scene", "air", False),),
    "air": (("scene", "air", True),),
    "air, fog": (("bruneton_sky", "fog_visibility_m", 1000.0),),
    "air, shafts": (
        ("bruneton_sky", "fog_visibility_m", None),
        ("scene", "light_shafts", True),
    ),
    "air, shafts, clouds 0.5": (("clouds", "coverage", 0.5),),
}
ROUNDS = 3
_EYE_M, _SPACE_M, _SUN_RAD = 2.0, 4e5, 0.5


def frame_table(size: tuple[int, int]) -> list[str]:
    """Lines of a Markdown table: cases by passes, ms."""
    lines = ["| frame | " + " | ".join(PASSES) + " |", "|---" * (len(PASSES) + 1) + "|"]
    project = msgspec.structs.replace(
        load_project(SCENE), size=size, slots={"sky": "bruneton_sky"}, at="2026-06-28T13:00"
    )
    with Host() as host:
        host.inject(*setting_inputs(project, host.kernel), *daylight_inputs(project))
        host.inject(*view_inputs(project))
        host.frame_skips = FrameSkips(shadow=False)
        by_query = "llvmpipe" not in host.gl.renderer
        timer = host.gl.call(lambda context: PassTimer(context, by_query))
        host.measure_passes(timer)
        for name, changes in CASES.items():
            inputs = [SetSetting(module=m, name=n, value=v) for m, n, v in changes]
            host.inject(*inputs)
            least = _least(host, timer)
            cells = [f"{1e3 * least.get(part, 0.0):.0f}" for part in PASSES]
            lines.append(f"| {name} | {' | '.join(cells)} |")
    return lines


def _least(host: Host, timer: PassTimer) -> dict[str, float]:
    host.draw()
    least: dict[str, float] = {}
    for _ in range(ROUNDS):
        timer.spent.clear()
        host.draw()
        least = {n: min(s, least.get(n, s)) for n, s in timer.spent.items()}
    return least


def volume_table() -> list[str]:
    """Lines of a Markdown table: volumes of either sky, ms."""
    sun = np.array([0.0, np.sin(_SUN_RAD), -np.cos(_SUN_RAD)])
    clear, foggy = (
        solve_air(atmosphere_of(BrunetonSkySettings(fog_visibility_m=visibility_m)))
        for visibility_m in (None, 1000.0)
    )
    hour = Daylight(
        turbidity=3.0,
        albedo=0.1,
        sun_colour="disc",
        apparent_elevation_rad=_SUN_RAD,
        sun_azimuth_rad=0.0,
        visible_disc_fraction=1.0,
    )
    direction = tuple(sun.tolist())
    works: dict[str, Callable[[], Any]] = {
        "Bruneton": lambda: air_volume(clear, _EYE_M, sun, 1e5),
        "Bruneton, for the GPU": lambda: air_volume_job(clear, _EYE_M, sun, 1e5, "bench", "air"),
        "Bruneton, fog": lambda: air_volume(foggy, _EYE_M, sun, 1e5),
        "Bruneton, from 400 km": lambda: air_volume(clear, _SPACE_M, sun, 5e6),
        "Hosek-Wilkie": lambda: exponential_air_volume(hour, direction, _EYE_M, 1e5),
    }
    lines = ["| volume | ms |", "|---|---|"]
    return lines + [f"| {name} | {1e3 * _seconds(work):.1f} |" for name, work in works.items()]


def _seconds(work: Callable[[], Any]) -> float:
    work()
    spent = []
    for _ in range(5 * ROUNDS):
        begun = time.process_time()
        work()
        spent.append(time.process_time() - begun)
    return min(spent)


def main(size: str = "480x270") -> None:
    """Print both tables."""
    width, _, height = size.partition("x")
    print("\n".join([*frame_table((int(width), int(height))), "", *volume_table()]))


if __name__ == "__main__":
    main(*sys.argv[1:2])

"""From the message that a scene is open to the first light on its surfaces, on the bus.

Each round opens the scene in a new kernel with a sky, without a window and without rays kept on
disk. Times are CPU time of all threads; wall times of a round mean something on a quiet machine
alone.
"""

import os
import tempfile
import time
from datetime import UTC, datetime
from unittest.mock import patch

from dynamic_skylight.module import DynamicSkyLight
from light_transport.module import LightTransport

from vrut_lite import compiled_code
from vrut_lite.errors import ModuleFailed
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, Message, SetClock
from vrut_lite.messages.light_map import SurfaceLightChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.scene.manager import SceneManager
from vrut_lite.sky.sky_sum import SkySum
from vrut_lite_lab.bench.bench_path import BenchPath, Group, Spent, Work, WorkClock
from vrut_lite_lab.bench.paths.frame import SCENES

FILES = (
    "work/indoor.glb", "large/hall.glb", "street.obj", "pavilion.gltf", "spheres.glb",
    "sundial.glb", "large/terrain.glb",
)  # fmt: skip
_NOON = datetime(2026, 6, 21, 10, 30, tzinfo=UTC)
_WAIT_S, _LIMIT_S = 0.002, 120.0


def groups(quick: bool) -> list[Group]:
    """A path a scene; the quick form has one."""
    there = [name for name in FILES if (SCENES / name).exists()]
    return [
        Group(
            name="first-light",
            title="From an open scene to its first light",
            unit="a scene",
            norm="none: times alone",
            truth="none",
            paths=tuple(map(_path, there[:1] if quick else there)),
            left_out={name: f"there is no {name}" for name in FILES if name not in there},
        )
    ]


def _path(name: str) -> BenchPath:
    def spent(_work: Work) -> Spent:
        return first_light(name)

    return BenchPath(
        name=name,
        family=name,
        parameters={},
        prepare=lambda: lambda: None,
        error=None,
        clock=WorkClock("CPU time of all threads from SceneOpened to the first light", spent),
    )


def first_light(name: str) -> Spent:
    """What a scene's first light takes.

    Raises:
        ModuleFailed: it does not come.
    """
    told: dict[type[Message], tuple[float, float]] = {}

    def note(message: Message, _sender: str) -> None:
        told.setdefault(type(message), (time.perf_counter(), time.process_time()))

    compiled_code.share_kernels()
    with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, XDG_CACHE_HOME=folder):
        kernel = Kernel()
        for module in (DynamicSkyLight, LightTransport, SceneManager, SkySum):
            kernel.add_module(module)
        kernel.inject(SetPlace(latitude_deg=50.0, longitude_deg=14.0))
        kernel.inject(SetClock(instant=_NOON))
        kernel.inject(Demand(consumer="bench", message=SurfaceLightChanged.__name__))
        kernel.pump_until_idle()
        kernel.tap(note)
        kernel.inject(LoadScene(path=str(SCENES / name)))
        limit_s = time.perf_counter() + _LIMIT_S
        while SurfaceLightChanged not in told:
            kernel.pump()
            if time.perf_counter() > limit_s:
                raise ModuleFailed(f"{name} has no light after {_LIMIT_S:g} s")
            time.sleep(_WAIT_S)
        kernel.close()
    opened, lit = told[SceneOpened], told[SurfaceLightChanged]
    return Spent(None, lit[1] - opened[1], lit[0] - opened[0])

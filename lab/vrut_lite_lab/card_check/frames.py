"""Frames a second along a fixed path, with the share of each pass, and a picture of each scene.

The picture is 1920 x 1080 with the shipped defaults. The camera turns about its target by two
degrees a frame; then it stands while the sun moves by a minute a frame. A frame ends when its
pixels are in the processor's memory.
"""

import math
import statistics
import time
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetClock
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.pictures.image_files import write_png
from vrut_lite.project import Project, daylight_inputs, setting_inputs, view_inputs
from vrut_lite.render.picture_passes import unmeasured
from vrut_lite_lab.bench.gl import PassTimer
from vrut_lite_lab.card_check.parts import Keep
from vrut_lite_lab.pictures.drawing import scene_project

SIZE = (1920, 1080)
_CLOUDS: dict[str, dict[str, Any]] = {"clouds": {"genus": "Cu"}}
_NOON, _DUSK = "2026-06-21T11:00", "2026-06-21T20:00"
_PLACE = "50.0755,14.4378,200"
SCENES: dict[str, tuple[str, dict[str, Any]]] = {
    "street": ("street.toml", {}),
    "pavilion": ("pavilion.gltf", {}),
    "pavilion, Bruneton's sky": ("pavilion.gltf", {"slots": {"sky": "bruneton_sky"}}),
    "terrain with clouds": (
        "large/terrain.toml",
        {"slots": {"sky": "bruneton_sky"}, "settings": _CLOUDS},
    ),
    "spheres at dusk": ("spheres.glb", {"at": _DUSK}),
    "hall": ("large/hall.toml", {}),
    "planet": ("large/planet.toml", {}),
}
_FRAMES, _PASS_FRAMES, _TURN_RAD = 40, 5, math.radians(2.0)


def measure(folder: Path, keep: Keep) -> None:
    """Draw all scenes; an error in one leaves the others."""
    found: dict[str, Any] = {}
    for name, (scene, changes) in SCENES.items():
        try:
            base = scene_project(scene)
            changed = {"at": base.at or _NOON, "place": base.place or _PLACE, **changes}
            project = msgspec.structs.replace(base, size=SIZE, **changed)
            found[name] = _of_scene(project, folder / f"{name.replace(' ', '_')}.png")
        except Exception as error:
            found[name] = {"error": f"{type(error).__name__}: {error}"[:500]}
        print(name, found[name], flush=True)
        keep(found)


def _of_scene(project: Project, picture: Path) -> dict[str, Any]:
    start_s = time.perf_counter()
    with Host() as host:
        host.inject(*setting_inputs(project, host.kernel), *daylight_inputs(project))
        *others, camera = sorted(view_inputs(project), key=lambda m: isinstance(m, MoveCamera))
        host.inject(*others, camera)
        host.settle()
        settled_s = time.perf_counter() - start_s
        first_s = _seconds(lambda: host.draw())
        write_png(picture, host.draw().display)
        camera = _camera(host)
        orbit = [_frame_s(host, _turned(camera, k * _TURN_RAD)) for k in range(_FRAMES)]
        instant = project.instant()
        suns = [
            _frame_s(host, SetClock(instant=instant + timedelta(minutes=k)))
            for k in range(1, _FRAMES // 2)
        ]
        return {
            "settled_s": settled_s,
            "first_draw_s": first_s,
            "orbit_ms": _median_ms(orbit[2:]),
            "orbit_worst_ms": 1e3 * max(orbit[2:]),
            "moved_sun_ms": _median_ms(suns[2:]),
            "passes_ms": _passes_ms(host, camera),
            "free_mib": _free_mib(host),
        }


def _seconds(work: Callable[[], Any]) -> float:
    start_s = time.perf_counter()
    work()
    return time.perf_counter() - start_s


def _median_ms(seconds: list[float]) -> float:
    return 1e3 * statistics.median(seconds)


def _frame_s(host: Host, moved: Any) -> float:
    def frame() -> None:
        host.inject(moved)
        # One pump, as a window does beside a moving picture: the light follows when it is ready.
        host.kernel.pump()
        host.draw_now(still=False)

    return _seconds(frame)


def _camera(host: Host) -> MoveCamera:
    camera = host.state.camera
    assert camera is not None
    return camera


def _turned(camera: MoveCamera, angle_rad: float) -> MoveCamera:
    """The camera turned about its target's vertical."""
    away = np.subtract(camera.eye_m, camera.target_m)
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    turned = (cos * away[0] + sin * away[2], away[1], cos * away[2] - sin * away[0])
    eye_m = tuple(float(x) for x in np.add(camera.target_m, turned))
    return msgspec.structs.replace(camera, eye_m=eye_m)


def _passes_ms(host: Host, camera: MoveCamera) -> dict[str, float]:
    """Each pass of a moving frame, the median of some frames."""
    timer = host.gl.call(PassTimer)
    spent: dict[str, list[float]] = {}
    host.measure_passes(timer)
    for k in range(_PASS_FRAMES):
        timer.spent.clear()
        host.inject(_turned(camera, (k + 1) * _TURN_RAD))
        host.kernel.pump()
        host.draw_now(still=False)
        for name, seconds in timer.spent.items():
            spent.setdefault(name, []).append(seconds)
    host.measure_passes(unmeasured)
    return {name: _median_ms(seconds) for name, seconds in spent.items()}


def _free_mib(host: Host) -> float | None:
    """Free memory of the card, which NVIDIA's driver reports."""

    def ask(context: Any) -> float | None:
        if "GL_NVX_gpu_memory_info" not in context.extensions:
            return None
        from OpenGL import GL

        return float(GL.glGetIntegerv(0x9049)) / 1024.0

    return host.gl.call(ask)

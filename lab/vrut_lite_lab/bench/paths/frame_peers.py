"""Whole frames beside pyrender's own renderer: the same scenes, size and samples, in one run.

pyrender draws meshes and the shadow map of a directional light, and reads back 8 bits; ours adds
sky, air, light between surfaces and reflections, and reads back radiance and 8 bits. The sun moves
before each whole frame, so that shadows and, where it is seen, the reflection are done anew; a film
frame repeats the last, on a processor with one sample a pixel and all that can be taken over.
pyrender keeps nothing between frames: both stand beside the same figure. Its shadow map spans the
ground too: its shadows are too coarse to be seen, and cheap to draw.
"""

from collections.abc import Callable
from datetime import datetime
from itertools import cycle
from typing import Any

import msgspec
import numpy as np

from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetClock
from vrut_lite.messages.camera import look_at
from vrut_lite.project import Project, daylight_inputs, load_project, setting_inputs, view_inputs
from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite_lab.bench.bench_path import (
    CPU_TIME,
    WALL_TIME,
    BenchPath,
    Group,
    Spent,
    Work,
    WorkClock,
)
from vrut_lite_lab.bench.gl import close_gl, has_timer, missing_gl, on_close, renderer
from vrut_lite_lab.bench.paths.frame import SCENES

SIZE = (960, 600)
_SCENES = {
    "street": "street.toml",
    "pavilion": "pavilion.gltf",
    "spheres": "spheres.glb",
    "terrain": "large/terrain.toml",
}
# The sun goes to and fro by as much as the reflection follows.
_HOURS = ("2026-06-21T11:00", "2026-06-21T11:20")
_LIGHT_WATTS = 5.0


def groups(quick: bool) -> list[Group]:
    """A group for each scene; the quick form leaves them out, as light maps take minutes."""
    reason = "takes minutes, which the quick form has not" if quick else missing_gl()
    return [
        Group(
            name=f"frame-beside-{name}",
            title=f"A frame of {name} beside pyrender's",
            unit="a frame",
            norm="none: a frame has no twin",
            truth="none",
            paths=() if reason else tuple(_paths(name)),
            left_out={name: reason} if reason else {},
        )
        for name in _SCENES
    ]


def _paths(scene: str) -> list[BenchPath]:
    clock = WALL_TIME if has_timer(renderer()) else CPU_TIME

    def after_a_moved_sun(work: Work) -> Spent:
        pair(scene).move_sun()
        return clock.time(work)

    def prepare(draw: Callable[["Pair"], Any]) -> Callable[[], Work]:
        def prepared() -> Work:
            # Its light map may take many times longer than a frame.
            opened = pair(scene)
            return lambda: draw(opened)

        return prepared

    drawn: dict[str, tuple[Callable[[Pair], Any], WorkClock]] = {
        "pyrender": (Pair.peer_frame, clock),
        "whole frame": (Pair.whole_frame, WorkClock(clock.name, after_a_moved_sun)),
        "film frame": (Pair.film_frame, clock),
    }

    return [
        BenchPath(
            name=f"{said}, {scene}",
            family=said,
            prepare=prepare(draw),
            error=None,
            batch=scene,
            clock=its_clock,
            device="GPU",
        )
        for said, (draw, its_clock) in drawn.items()
    ]


_pairs: dict[str, "Pair"] = {}


def pair(scene: str) -> "Pair":
    """The two renderers of a scene; there is one pair at a time, and no other OpenGL context."""
    if scene not in _pairs:
        close_gl()
        made = Pair(scene)
        on_close(_pairs.clear)
        on_close(made.close)
        _pairs[scene] = made
    return _pairs[scene]


class Pair:
    """A host with a scene open, and pyrender's renderer with the same scene in the same context."""

    def __init__(self, scene: str, size: tuple[int, int] = SIZE):
        project = _project(_SCENES[scene], size)
        self.host = Host()
        self.host.inject(*setting_inputs(project, self.host.kernel), *daylight_inputs(project))
        self.host.inject(*view_inputs(project))
        self.host.draw()
        moved = project.instant() - Project(scene="", at=_HOURS[0]).instant()
        self._hours = cycle(Project(scene="", at=hour).instant() + moved for hour in _HOURS)
        self._peer = self.host.gl.call(lambda _: _Peer(self.host, size))
        self.move_sun()

    def move_sun(self) -> None:
        """Let sky and light of the next hour be done; the next whole frame draws them."""
        hour: datetime = next(self._hours)
        self.host.inject(SetClock(instant=hour))
        self.host.settle()

    def whole_frame(self) -> Any:
        """A finished frame after a moved sun."""
        return self.host.draw_now(still=True)

    def film_frame(self) -> Any:
        """The same again."""
        return self.host.draw_now(still=False)

    def peer_frame(self) -> Any:
        """pyrender's frame with its shadow map."""
        return self.host.gl.call(lambda context: self._peer.draw(context))

    def close(self) -> None:
        """Free all."""
        self.host.gl.call(lambda _: self._peer.renderer.delete())
        self.host.close()


class _Peer:
    """pyrender's renderer as it comes; on the GL thread only."""

    def __init__(self, host: Host, size: tuple[int, int]):
        import_pyrender()
        from pyrender.camera import PerspectiveCamera
        from pyrender.constants import RenderFlags
        from pyrender.light import DirectionalLight
        from pyrender.mesh import Mesh
        from pyrender.renderer import Renderer
        from pyrender.scene import Scene

        state = host.state
        camera, light = state.camera, state.key_light
        assert state.scene is not None
        assert camera is not None
        assert light is not None
        ours = PyrenderScene(state.scene)
        self._scene = Scene(bg_color=[0.4, 0.6, 0.9], ambient_light=[0.3, 0.3, 0.3])
        meshes: dict[int, Any] = {}
        for placed in ours.placed:
            key = id(placed.primitive)
            meshes[key] = meshes.get(key) or Mesh([placed.primitive])
            self._scene.add(meshes[key], pose=placed.world_from_model)
        eye_m = np.asarray(camera.eye_m, dtype=float)
        seen = PerspectiveCamera(
            camera.vertical_field_of_view_rad, znear=0.05, zfar=10.0 * ours.radius_m + 1000.0
        )
        pose = np.linalg.inv(look_at(np.zeros(3), np.asarray(camera.target_m) - eye_m))
        pose[:3, 3] = eye_m
        self._scene.add(seen, pose=pose)
        sun = DirectionalLight(intensity=_LIGHT_WATTS)
        towards = np.asarray(light.direction)
        self._scene.add(sun, pose=np.linalg.inv(look_at(np.zeros(3), -towards)))
        self.renderer = Renderer(*size)
        self._flags = RenderFlags.OFFSCREEN | RenderFlags.SHADOWS_DIRECTIONAL

    def draw(self, context: Any) -> Any:
        colour, _ = self.renderer.render(self._scene, self._flags)
        context.extra.use()
        return colour


def _project(scene: str, size: tuple[int, int]) -> Project:
    if not scene.endswith(".toml"):
        return Project(scene=str(SCENES / scene), at=_HOURS[0], size=size)
    project = load_project(SCENES / scene)
    at = project.at or _HOURS[0]
    return msgspec.structs.replace(project, size=size, at=at)

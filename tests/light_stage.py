"""A kernel with light transport, a scene of boxes, and a sky that a test plays."""

from typing import ClassVar

import msgspec
import numpy as np
from lamp_maker import lamps_of
from light_messages import light_messages
from light_transport.module import LightTransport

from vrut_lite.array import Array
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, Input, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.sky import SkyRadianceChanged
from vrut_lite.messages.view_light import StillAsked
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed
from vrut_lite.sky.sky_sum import SkySum

WANT = Demand(consumer="test", message="SurfaceLightChanged")
NO_MORE = Demand(consumer="test", message="SurfaceLightChanged", size=0)
# Texels half a metre wide and few rays: a bake takes some milliseconds.
COARSE = (
    SetSetting(module="light_transport", name="quality", value="draft"),
    SetSetting(module="light_transport", name="texel_m", value=0.5),
)
# Corner by corner, as OBJ counts them; seen from outside the order is counter-clockwise.
_BOX_FACES = ("4 3 2 1", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8")


def box_file(folder, name="boxes.obj", *, boxes=((0.0, 2.0),), colour=0.5):
    """An OBJ file of cubes: the x of each one's middle, and its edge in metres."""
    (folder / f"{name}.mtl").write_text(f"newmtl grey\nKd {colour} {colour} {colour}\nNs 1\n")
    lines, first = [f"mtllib {name}.mtl", "usemtl grey"], 0
    for number, (x, edge) in enumerate(boxes):
        lines.append(f"o box{number}")
        h = 0.5 * edge
        corners = [(-h, -h), (h, -h), (h, h), (-h, h)]
        lines += [f"v {x + a} {b} {-h}" for a, b in corners]
        lines += [f"v {x + a} {b} {h}" for a, b in corners]
        lines += [
            "f " + " ".join(str(first + int(corner)) for corner in face.split())
            for face in _BOX_FACES
        ]
        first += 8
    path = folder / name
    path.write_text("\n".join(lines) + "\n")
    return path


class Show(Input, frozen=True, kw_only=True):
    """Post the scene of a file, as the scene manager does; without the ground that it stands on,
    whose texels would be many more than its own."""

    path: str
    with_ground: bool = False
    with_parts: bool = True
    with_lamp: bool = False

    def key(self) -> None:
        return None


class Shine(Input, frozen=True, kw_only=True):
    """A sky of this radiance above a black ground, and a sun in this direction."""

    radiance: float
    sun: tuple[float, float, float] = (0.0, 1.0, 0.0)
    irradiance: float = 0.0


class Look(Input, frozen=True, kw_only=True):
    """A picture of 24 x 16 pixels is to be finished, seen from here towards the origin."""

    eye_m: tuple[float, float, float]


class Player(Module):
    """Posts scenes and skies as tests say."""

    manifest: ClassVar[Manifest] = Manifest(
        name="player", title="Player", version="1", provides=("sky",)
    )

    @handles(Show)
    def on_show(self, message: Show) -> None:
        scene = packed(load_scene(message.path))
        if not message.with_ground:
            scene = msgspec.structs.replace(scene, ground=None)
        if message.with_lamp:
            scene = msgspec.structs.replace(scene, lamps=lamps_of({"position_m": (0.0, 3.0, 0.0)}))
        if not message.with_parts:
            geometry = msgspec.structs.replace(
                scene.geometry,
                part_mesh=Array(np.empty(0, np.int32)),
                world_from_part=Array(np.empty((0, 4, 4))),
            )
            scene = msgspec.structs.replace(scene, geometry=geometry, triangles=0)
        self.link.post(scene)

    @handles(Look)
    def on_look(self, message: Look) -> None:
        camera = MoveCamera(eye_m=message.eye_m, target_m=(0.0, 1.0, 0.0))
        self.link.post(StillAsked(camera=camera, size_px=(24, 16)))

    @handles(Shine)
    def on_shine(self, message: Shine) -> None:
        above = texel_directions(8)[..., 1:2] > 0.0
        cube = np.where(above, message.radiance, 0.0) * np.ones(3)
        background, key_light, ambient = light_messages(
            cube, message.sun, (message.irradiance,) * 3
        )
        self.link.post(background)
        self.link.post(key_light)
        self.link.post(ambient)
        self.link.post(
            SkyRadianceChanged(
                cube=Array(cube.astype(np.float16)),
                radiance_scale=1.0,
                ground_radiance_rgb=background.ground_radiance_rgb,
                source="test",
            )
        )


class LightStage:
    """The kernel, and all that the module said."""

    def __init__(self, runner=None):
        self.kernel = Kernel(runner=runner)
        self.said = []
        self.kernel.tap(self._note)
        for module in (Player, LightTransport, SkySum):
            self.kernel.add_module(module)

    def _note(self, message, sender):
        if sender == "light_transport":
            self.said.append(message)

    def tell(self, *inputs):
        """Each input in turn, until all that it causes is done; what the module said to it."""
        self.said.clear()
        for message in inputs:
            self.kernel.inject(message)
            self.kernel.pump_until_idle()
        return list(self.said)

    def set(self, name, value):
        return self.tell(SetSetting(module="light_transport", name=name, value=value))

    @property
    def counters(self):
        return self.kernel.seats["light_transport"].module.counters


def of_kind(messages, kind):
    return [message for message in messages if type(message) is kind]


def lights(messages):
    return of_kind(messages, SurfaceLightChanged)


def layouts(messages):
    return of_kind(messages, LightMapLaid)

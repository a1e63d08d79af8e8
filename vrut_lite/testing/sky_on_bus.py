"""One sky on a real kernel, with a sun and an eye that a test moves."""

import math
from typing import Any, TypeVar

import numpy as np

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    ChooseSlot,
    Demand,
    Derived,
    Fault,
    Input,
    JobResult,
    Message,
    SetSetting,
)
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneNeeds
from vrut_lite.messages.sun import SunMoved
from vrut_lite.recording.replay_runner import ReplayRunner
from vrut_lite.sky.sky_module import PRODUCTS, SkyModule

M = TypeVar("M", bound=Message)
_SUN_RADIUS_RAD = 0.00465


class SunAndEye(Module):
    """Stands in for the sun's module and for the scene manager.

    A place puts the sun at the elevation of its latitude and the azimuth of its longitude; a camera
    puts the eye at its height, and surfaces at the distance of its target.
    """

    manifest = Manifest(name="sun_and_eye", title="Sun and eye", version="1", provides=("sun",))

    @handles(SetPlace)
    def place_set(self, place: SetPlace) -> None:
        """Move the sun."""
        elevation_rad, azimuth_rad = (
            math.radians(angle) for angle in (place.latitude_deg, place.longitude_deg)
        )
        level = math.cos(elevation_rad)
        x, z = level * math.sin(azimuth_rad), -level * math.cos(azimuth_rad)
        self.link.post(
            SunMoved(
                direction=(x, math.sin(elevation_rad), z),
                azimuth_rad=azimuth_rad,
                elevation_rad=elevation_rad,
                apparent_elevation_rad=elevation_rad,
                visible_disc_fraction=min(max(0.5 + 0.5 * elevation_rad / _SUN_RADIUS_RAD, 0), 1),
            )
        )

    @handles(MoveCamera)
    def camera_moved(self, camera: MoveCamera) -> None:
        """Post the eye's height and the distance of surfaces."""
        self.link.post(
            SceneNeeds(
                sky_in_view=True,
                visible_faces=(0,),
                receives_light=True,
                air_reach_m=float(np.linalg.norm(np.subtract(camera.target_m, camera.eye_m))),
                eye_height_m=camera.eye_m[1],
            )
        )


class AnotherSky(Module):
    """A sky that posts nothing."""

    manifest = Manifest(
        name="another_sky", title="Another sky", version="1", provides=("sky",), stand_in=False
    )


class SkyOnBus:
    """A kernel with one sky, `SunAndEye` and `AnotherSky`; every method acts until all is done.

    Background jobs run when they are started, unless `holding` is set: then `finish` runs them.
    """

    def __init__(self, module_type: type[SkyModule], **settings: Any):
        self._runner = ReplayRunner()
        self.kernel = Kernel(runner=self._runner)
        self.name = module_type.manifest.name
        self.holding = False
        self.faults: list[str] = []
        self._posted: list[Derived] = []
        for kind in (SunAndEye, AnotherSky, module_type):
            self.kernel.add_module(kind)
        self.kernel.tap(self._hear)
        for name, value in settings.items():
            self.set(name, value)
        self.tell(ChooseSlot(slot="sun", module=SunAndEye.manifest.name))
        self.regain_slot()

    def _hear(self, message: Message, sender: str) -> None:
        if isinstance(message, Fault):
            self.faults.append(message.error)
        elif sender == self.name and isinstance(message, Derived):
            self._posted.append(message)

    # --- what a test does ----------------------------------------------------------------

    def tell(self, *messages: Input) -> None:
        """Inject inputs, one after the other."""
        for message in messages:
            self.kernel.inject(message)
            self.kernel.pump()
            if not self.holding:
                self.kernel.pump_until_idle()

    def finish(self) -> None:
        """Do the background jobs that are held."""
        self.kernel.pump_until_idle()

    def want(self, *kinds: type[Message], size: int | None = None) -> None:
        """Demand messages; by default all that a sky posts."""
        for kind in kinds or PRODUCTS:
            self.tell(Demand(consumer="test", message=kind.__name__, size=size))

    def want_no_more(self, *kinds: type[Message]) -> None:
        """Take demands back."""
        self.want(*kinds, size=0)

    def sun(self, elevation_deg: float, azimuth_deg: float = 0.0, ground_m: float = 0.0) -> None:
        """Move the sun, in degrees, and the ground's altitude."""
        place = {"latitude_deg": elevation_deg, "longitude_deg": azimuth_deg}
        self.tell(SetPlace(**place, altitude_m=ground_m))

    def eye(self, height_m: float, reach_m: float = 1.0) -> None:
        """Move the eye to a height, with surfaces at a distance."""
        self.tell(
            MoveCamera(eye_m=(0.0, height_m, 0.0), target_m=(0.0, height_m, -reach_m)),
        )

    def set(self, name: str, value: Any) -> None:
        """Give a setting of the sky a value."""
        self.tell(SetSetting(module=self.name, name=name, value=value))

    def lose_slot(self) -> None:
        """Give the slot to another sky."""
        self.tell(ChooseSlot(slot="sky", module=AnotherSky.manifest.name))

    def regain_slot(self) -> None:
        """Give the slot to the sky."""
        self.tell(ChooseSlot(slot="sky", module=self.name))

    def answer(self, job: GpuJob, error: str = "") -> None:
        """Bring the result of a job for the GPU as its owner would."""
        texture = GpuTexture(size=job.size, format=job.format, recipe=job.recipe)
        value = None if error else texture
        self.tell(JobResult(module=job.module, job=job.job, value=value, error=error))

    # --- what a test asks ----------------------------------------------------------------

    def taken(self) -> list[Derived]:
        """Messages that the sky has posted since the last call."""
        posted, self._posted = self._posted, []
        return posted

    def kinds_taken(self) -> list[type[Derived]]:
        """Types of the messages that the sky has posted since the last call."""
        return [type(message) for message in self.taken()]

    def last(self, kind: type[M]) -> M:
        """The latest message of a type."""
        message = self.kernel.last(kind)
        assert message is not None, f"no {kind.__name__} was posted"
        return message

    @property
    def held(self) -> list[str]:
        """Names of the background jobs that are held."""
        return [job for _, job in self._runner.held]

    @property
    def counters(self) -> WorkCounters:
        """The sky's counters."""
        return self.kernel.seats[self.name].counters

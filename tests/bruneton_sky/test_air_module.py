"""The air that the module posts: when, how far, and when not."""

from typing import Any

import msgspec
import numpy as np
import pytest
from bruneton_sky.module import BrunetonSky
from bruneton_sky.settings import BrunetonSkySettings
from bruneton_sky.sky_view import STANDING_M

from vrut_lite.array import Array
from vrut_lite.daylight.air import AirChanged, AirVolume
from vrut_lite.daylight.air_volume import look_up_air
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.scene import SceneNeeds
from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged, SunMoved
from vrut_lite.errors import UserError
from vrut_lite.gpu_job import GpuJob, GpuTexture
from vrut_lite.kernel.job import JobControl
from vrut_lite.kernel.messages import Demand, Derived, JobResult, Message, SetSetting, SlotChanged
from vrut_lite.recording.codec import to_plain


class Link:
    """A kernel's side: jobs are done when asked for, all that was said is remembered."""

    def __init__(self) -> None:
        self.posted: list[Derived] = []
        self.demands: dict[type[Message], Demand] = {}
        self.memory: dict[type[Message], Any] = {}
        self.holder = True
        self.waiting: list[tuple[str, Any]] = []

    def post(self, message: Derived) -> None:
        self.posted.append(message)

    def wanted(self, message_type: type[Message]) -> Demand | None:
        return self.demands.get(message_type)

    def holds(self, slot: str) -> bool:
        return self.holder and slot == "sky"

    def last(self, message_type: type[Message]) -> Any:
        return self.memory.get(message_type)

    def start_job(self, name: str, work: Any, *arguments: Any) -> None:
        self.waiting.append((name, work(*arguments, control=JobControl(lambda _text: None))))

    def cancel_job(self, name: str) -> None:
        self.waiting = [job for job in self.waiting if job[0] != name]

    def want(self, kind: type[Message]) -> None:
        self.demands[kind] = Demand(consumer="test", message=kind.__name__, size=8)

    def air(self) -> list[AirVolume | None]:
        """The volumes that were posted since last asked."""
        found = [m.volume for m in self.posted if isinstance(m, AirChanged)]
        self.posted.clear()
        return found


@pytest.fixture
def link() -> Link:
    """Someone wants air."""
    link = Link()
    link.want(AirChanged)
    return link


@pytest.fixture
def sky(link: Link) -> BrunetonSky:
    return BrunetonSky(link, BrunetonSkySettings(orders=2))


def tell(sky: BrunetonSky, link: Link, message: Message) -> None:
    """Deliver a message as the kernel would, and let its jobs finish."""
    link.memory[type(message)] = message
    for kind, method in sky.handlers():
        if kind is type(message):
            getattr(sky, method)(message)
    while link.waiting:
        name, value = link.waiting.pop(0)
        sky.job_done(JobResult(module="bruneton_sky", job=name, value=value))


def sun_at(elevation_deg: float) -> SunMoved:
    """A sun in the north."""
    e = float(np.radians(elevation_deg))
    return SunMoved(
        direction=(0.0, float(np.sin(e)), -float(np.cos(e))),
        azimuth_rad=0.0,
        elevation_rad=e,
        apparent_elevation_rad=e,
        visible_disc_fraction=1.0,
    )


def needs(reach_m: float, height_m: float = 0.0) -> SceneNeeds:
    """A scene whose farthest thing stands so far off, seen from so high up."""
    return SceneNeeds(
        sky_in_view=True,
        visible_faces=(0,),
        receives_light=True,
        air_reach_m=reach_m,
        eye_height_m=height_m,
    )


def camera_at(height_m: float) -> MoveCamera:
    return MoveCamera(eye_m=(0.0, height_m, 0.0), target_m=(0.0, height_m, -1.0))


def test_air_is_posted_where_things_stand_in_it(sky: BrunetonSky, link: Link) -> None:
    """Nothing without things in the air; then a volume that reaches past them, for the eye and
    the sun there are."""
    tell(sky, link, sun_at(30.0))
    assert link.air() == []
    assert sky.ledger.skipped["AirChanged: nothing stands in it"] == 1
    tell(sky, link, needs(20_000.0, 100.0))
    (volume,) = link.air()
    assert volume is not None
    assert volume.reach_m >= 20_000.0
    assert volume.observer_altitude_m == 100.0
    assert volume.sun_direction == sun_at(30.0).direction
    light = look_up_air(volume, np.array([0.0, 0.0, -1.0]), 10_000.0)
    assert np.all((light.transmittance > 0.05) & (light.transmittance < 0.6))
    assert np.all(light.shaded > 0.1)


def test_nothing_is_made_twice(sky: BrunetonSky, link: Link) -> None:
    """The same things in view, or some a little nearer or farther on the same rung, or an eye
    that moved unseen: no new volume. Things far beyond: one."""
    tell(sky, link, sun_at(30.0))
    tell(sky, link, needs(20_000.0))
    assert len(link.air()) == 1
    for message in (needs(20_000.0), needs(19_500.0), needs(20_000.0, 1.7), sun_at(30.0001)):
        tell(sky, link, message)
    assert link.air() == []
    assert sky.ledger.skipped["AirChanged: nothing changed"] >= 2
    tell(sky, link, needs(100_000.0))
    assert len(link.air()) == 1
    tell(sky, link, sun_at(31.0))
    assert len(link.air()) == 1


def test_nobody_pays_for_what_nobody_wants(sky: BrunetonSky, link: Link) -> None:
    """Without a demand there is no air, and with air alone wanted no sky-view table is made."""
    tell(sky, link, sun_at(30.0))
    tell(sky, link, needs(20_000.0))
    assert len(link.air()) == 1
    assert "sky-view table" not in sky.ledger.done
    del link.demands[AirChanged]
    link.want(KeyLightChanged)
    tell(sky, link, sun_at(40.0))
    assert link.air() == []
    assert sky.ledger.skipped["AirChanged: nobody wants it"] == 1


def test_air_too_thin_to_be_seen_is_none(sky: BrunetonSky, link: Link) -> None:
    """Around a thing on a table the air takes less than a 2000th of the light: the message says
    that there is none, once, and takes away what was there before."""
    tell(sky, link, sun_at(30.0))
    tell(sky, link, needs(1.0))
    tell(sky, link, needs(0.9))
    assert link.air() == [None]
    tell(sky, link, needs(5000.0))
    tell(sky, link, needs(1.0))
    far, near = link.air()
    assert far is not None
    assert near is None


def test_air_seen_from_space(sky: BrunetonSky, link: Link) -> None:
    """From above the air its reach counts from where it begins; things that stand before it have
    none in front."""
    tell(sky, link, sun_at(60.0))
    tell(sky, link, needs(5e6, 1e7))
    assert link.air() == [None]
    tell(sky, link, needs(1.2e7, 1e7))
    (volume,) = link.air()
    assert volume is not None
    assert 2e6 < volume.reach_m < 1.2e7


def test_air_follows_slot_and_settings(sky: BrunetonSky, link: Link) -> None:
    """Haze makes other air; and after another sky was shown it is told again."""
    tell(sky, link, sun_at(30.0))
    tell(sky, link, needs(20_000.0))
    (clear,) = link.air()
    sky.settings = BrunetonSkySettings(orders=2, turbidity=8.0)
    sky.settings_changed("turbidity")
    tell(sky, link, SetSetting(module="x", name="y", value=1))
    (hazy,) = link.air()
    assert clear is not None
    assert hazy is not None
    view = np.array([0.0, 0.0, -1.0])
    through = [look_up_air(volume, view, 1e4).transmittance for volume in (clear, hazy)]
    assert np.all(through[1] < 0.5 * through[0])
    tell(sky, link, SlotChanged(name="sky", holder="bruneton_sky"))
    assert len(link.air()) == 1


@pytest.mark.parametrize(("height_m", "through"), [(2.0, False), (STANDING_M + 20.0, True)])
def test_background_says_whether_air_is_before_its_ground(
    sky: BrunetonSky, link: Link, height_m: float, through: bool
) -> None:
    """Who stands gets bare ground and is to draw the air before it; from higher up the ground in
    the map is seen through the air already: to draw it twice would double it."""
    link.want(BackgroundChanged)
    tell(sky, link, sun_at(30.0))
    tell(sky, link, camera_at(height_m))
    background = next(m for m in reversed(link.posted) if isinstance(m, BackgroundChanged))
    assert background.ground_through_air is through


@pytest.fixture
def gpu_sky(link: Link) -> BrunetonSky:
    """With the GPU chosen, and somebody to run its jobs."""
    link.want(GpuJob)
    return BrunetonSky(link, BrunetonSkySettings(orders=2, cube_device="gpu"))


def done(sky: BrunetonSky, job: Derived, **result: Any) -> None:
    """What whoever runs GPU jobs answers, as a journal tells it: in plain fields."""
    assert isinstance(job, GpuJob)
    texture = GpuTexture(size=job.size, format=job.format, recipe=job.recipe)
    answer = {"value": to_plain(texture)} | result
    sky.job_done(JobResult(module=job.module, job=job.job, **answer))


def test_the_gpu_fills_the_air(gpu_sky: BrunetonSky, link: Link) -> None:
    """A job, nothing of which is read back; its texture becomes the light of a volume that is
    otherwise the CPU's."""
    tell(gpu_sky, link, sun_at(30.0))
    tell(gpu_sky, link, needs(20_000.0))
    (job,) = link.posted
    assert isinstance(job, GpuJob)
    assert (job.job, job.output, job.read_back) == ("air", "3d", False)
    done(gpu_sky, job)
    (_, message) = link.posted
    assert isinstance(message, AirChanged)
    assert message.volume is not None
    assert message.volume.light == GpuTexture(
        size=(32, 56, 96), format=job.format, recipe=job.recipe
    )
    link.posted.clear()
    gpu_sky.settings = BrunetonSkySettings(orders=2)
    gpu_sky.settings_changed("cube_device")
    (volume,) = link.air()
    assert volume is not None
    light = {"light": message.volume.light, "radiance_scale": message.volume.radiance_scale}
    assert msgspec.structs.replace(volume, **light) == message.volume


def test_air_that_comes_late_is_not_shown(gpu_sky: BrunetonSky, link: Link) -> None:
    """What was asked for before the newest air, or before there was none to be seen, is no news."""
    tell(gpu_sky, link, sun_at(30.0))
    tell(gpu_sky, link, needs(20_000.0))
    tell(gpu_sky, link, sun_at(31.0))
    old, new = link.posted
    done(gpu_sky, new)
    done(gpu_sky, old)
    assert len(link.air()) == 1
    assert gpu_sky.ledger.skipped["GpuJob outdated"] == 1
    tell(gpu_sky, link, sun_at(32.0))
    (job,) = link.posted
    tell(gpu_sky, link, needs(1.0))
    done(gpu_sky, job)
    assert link.air() == [None]
    assert gpu_sky.ledger.skipped["GpuJob outdated"] == 2


def test_cube_map_and_air_wait_each_for_its_own_texture(gpu_sky: BrunetonSky, link: Link) -> None:
    """Whichever comes first, neither makes the other late."""
    link.want(BackgroundChanged)
    tell(gpu_sky, link, sun_at(30.0))
    tell(gpu_sky, link, needs(20_000.0))
    cube, air = sorted(link.posted, key=lambda job: getattr(job, "job", ""), reverse=True)
    done(gpu_sky, air)
    done(gpu_sky, cube)
    said = [type(message) for message in link.posted[2:]]
    assert said == [AirChanged, BackgroundChanged]


def test_a_job_that_failed_unwanted_is_made_up_for(gpu_sky: BrunetonSky, link: Link) -> None:
    """Who went indoors before it failed, and comes out when the GPU is chosen anew, has air."""
    tell(gpu_sky, link, sun_at(30.0))
    tell(gpu_sky, link, needs(20_000.0))
    demand = link.demands.pop(AirChanged)
    with pytest.raises(UserError, match="set cube_device to cpu"):
        done(gpu_sky, link.posted[-1], value=None, error="out of memory")
    link.posted.clear()
    gpu_sky.settings_changed("cube_device")
    link.demands[AirChanged] = demand
    tell(gpu_sky, link, demand)
    (job,) = link.posted
    assert isinstance(job, GpuJob)


@pytest.mark.parametrize("hindrance", ["nobody runs GPU jobs", "the GPU failed"])
def test_where_the_gpu_does_not_serve_the_cpu_does(
    gpu_sky: BrunetonSky, link: Link, hindrance: str
) -> None:
    """Air is there all the same, and the ledger says why the GPU had nothing to do."""
    if hindrance == "nobody runs GPU jobs":
        del link.demands[GpuJob]
    tell(gpu_sky, link, sun_at(30.0))
    tell(gpu_sky, link, needs(20_000.0))
    if hindrance == "the GPU failed":
        with pytest.raises(UserError, match="set cube_device to cpu"):
            done(gpu_sky, link.posted[-1], value=None, error="out of memory")
    (volume,) = link.air()
    assert volume is not None
    assert isinstance(volume.light, Array)
    assert gpu_sky.ledger.skipped[f"GpuJob: {hindrance}"] == 1

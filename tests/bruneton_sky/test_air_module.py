"""The air that the module posts: when, how far, and when not."""

import msgspec
import numpy as np
import pytest
from bruneton_sky.module import BrunetonSky
from bruneton_sky.sky_view import STANDING_M

from vrut_lite.array import Array
from vrut_lite.messages.air import AirChanged, AirVolume
from vrut_lite.messages.gpu_job import GpuJob, GpuTexture
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.sky.air_volume import look_up_air
from vrut_lite.testing.sky_on_bus import SkyOnBus


def air_of(sky: SkyOnBus) -> list[AirVolume | None]:
    """The volumes that were posted since last asked."""
    return [m.volume for m in sky.taken() if isinstance(m, AirChanged)]


@pytest.fixture
def sky() -> SkyOnBus:
    """Someone wants air, and the sun stands at 30 degrees."""
    sky = SkyOnBus(BrunetonSky, orders=2)
    sky.want(AirChanged, size=8)
    sky.sun(30.0)
    return sky


def test_air_is_posted_where_things_stand_in_it(sky: SkyOnBus) -> None:
    """Nothing without things in the air; then a volume that reaches past them, for the eye and
    the sun there are."""
    assert air_of(sky) == []
    assert sky.counters.skipped["AirChanged without things in it"] == 1
    sky.eye(100.0, 20_000.0)
    (volume,) = air_of(sky)
    assert volume is not None
    assert volume.reach_m >= 20_000.0
    assert volume.observer_altitude_m == 100.0
    assert volume.sun_direction == sky.last(SunMoved).direction
    light = look_up_air(volume, np.array([0.0, 0.0, -1.0]), 10_000.0)
    assert np.all((light.transmittance > 0.05) & (light.transmittance < 0.6))
    assert np.all(light.shaded > 0.1)


def test_nothing_is_made_twice(sky: SkyOnBus) -> None:
    """The same things in view, or some a little nearer or farther on the same rung, or an eye
    that moved unseen: no new volume. Things far beyond: one."""
    sky.eye(0.0, 20_000.0)
    assert len(air_of(sky)) == 1
    for height_m, reach_m in ((0.0, 20_000.0), (0.0, 19_500.0), (1.7, 20_000.0)):
        sky.eye(height_m, reach_m)
    sky.sun(30.0001)
    assert air_of(sky) == []
    assert sky.counters.skipped["AirChanged unchanged"] >= 2
    sky.eye(0.0, 100_000.0)
    assert len(air_of(sky)) == 1
    sky.sun(31.0)
    assert len(air_of(sky)) == 1


def test_air_without_demand_costs_nothing(sky: SkyOnBus) -> None:
    """Without a demand there is no air, and with air alone wanted no sky-view table is made."""
    sky.eye(0.0, 20_000.0)
    assert len(air_of(sky)) == 1
    assert "sky-view table" not in sky.counters.done
    sky.want_no_more(AirChanged)
    sky.want(KeyLightChanged)
    sky.sun(40.0)
    assert air_of(sky) == []


def test_air_too_thin_to_be_seen_is_none(sky: SkyOnBus) -> None:
    """Around a thing on a table the air takes less than a 2000th of the light: the message says
    that there is none, once, and takes away what was there before."""
    sky.eye(0.0, 1.0)
    sky.eye(0.0, 0.9)
    assert air_of(sky) == [None]
    sky.eye(0.0, 5000.0)
    sky.eye(0.0, 1.0)
    far, near = air_of(sky)
    assert far is not None
    assert near is None


def test_air_seen_from_space(sky: SkyOnBus) -> None:
    """From above the air its reach counts from where it begins; things that stand before it have
    none in front."""
    sky.eye(1e7, 5e6)
    assert air_of(sky) == [None]
    sky.eye(1e7, 1.2e7)
    (volume,) = air_of(sky)
    assert volume is not None
    assert 2e6 < volume.reach_m < 1.2e7


def test_air_follows_slot_and_settings(sky: SkyOnBus) -> None:
    """Haze makes other air; and after another sky was shown it is posted again."""
    sky.eye(0.0, 20_000.0)
    (clear,) = air_of(sky)
    sky.set("turbidity", 8.0)
    draft, hazy = air_of(sky)
    assert draft is not None
    assert clear is not None
    assert hazy is not None
    view = np.array([0.0, 0.0, -1.0])
    through = [look_up_air(volume, view, 1e4).transmittance for volume in (clear, hazy)]
    assert np.all(through[1] < 0.5 * through[0])
    sky.lose_slot()
    sky.regain_slot()
    assert len(air_of(sky)) == 1


@pytest.mark.parametrize(("height_m", "through"), [(2.0, False), (STANDING_M + 20.0, True)])
def test_background_says_whether_air_is_before_its_ground(
    sky: SkyOnBus, height_m: float, through: bool
) -> None:
    """Who stands gets bare ground and is to draw the air before it; from higher up the ground in
    the map is seen through the air already: to draw it twice would double it."""
    sky.want(BackgroundChanged, size=8)
    sky.eye(height_m)
    assert sky.last(BackgroundChanged).ground_through_air is through


@pytest.fixture
def gpu_sky() -> SkyOnBus:
    """With the GPU chosen, and somebody to run its jobs."""
    sky = SkyOnBus(BrunetonSky, orders=2, cube_device="gpu")
    sky.want(GpuJob)
    sky.want(AirChanged)
    sky.sun(30.0)
    return sky


def jobs_of(sky: SkyOnBus) -> list[GpuJob]:
    """What was posted since last asked, which is jobs alone."""
    posted = sky.taken()
    jobs = [message for message in posted if isinstance(message, GpuJob)]
    assert len(jobs) == len(posted)
    return jobs


def test_the_gpu_fills_the_air(gpu_sky: SkyOnBus) -> None:
    """A job, nothing of which is read back; its texture becomes the light of a volume that is
    otherwise the CPU's."""
    gpu_sky.eye(0.0, 20_000.0)
    (job,) = jobs_of(gpu_sky)
    assert (job.job, job.output, job.read_back) == ("air", "3d", False)
    gpu_sky.answer(job)
    (of_gpu,) = air_of(gpu_sky)
    assert of_gpu is not None
    assert of_gpu.light == GpuTexture(size=(24, 84, 96), format=job.format, recipe=job.recipe)
    gpu_sky.set("cube_device", "cpu")
    (of_cpu,) = air_of(gpu_sky)
    assert of_cpu is not None
    light = {"light": of_gpu.light, "radiance_scale": of_gpu.radiance_scale}
    assert msgspec.structs.replace(of_cpu, **light) == of_gpu


def test_air_that_comes_late_is_not_shown(gpu_sky: SkyOnBus) -> None:
    """Air is dropped that was requested before the shown one, or before its reach became zero."""
    gpu_sky.eye(0.0, 20_000.0)
    gpu_sky.sun(31.0)
    old, new = jobs_of(gpu_sky)
    gpu_sky.answer(new)
    gpu_sky.answer(old)
    assert len(air_of(gpu_sky)) == 1
    assert gpu_sky.counters.skipped["GpuJob outdated"] == 1
    gpu_sky.sun(32.0)
    (job,) = jobs_of(gpu_sky)
    gpu_sky.eye(0.0, 1.0)
    gpu_sky.answer(job)
    assert air_of(gpu_sky) == [None]
    assert gpu_sky.counters.skipped["GpuJob outdated"] == 2


def test_cube_map_and_air_wait_each_for_its_own_texture(gpu_sky: SkyOnBus) -> None:
    """Whichever comes first, neither makes the other late."""
    gpu_sky.want(BackgroundChanged, size=8)
    gpu_sky.eye(0.0, 20_000.0)
    jobs = {job.job: job for job in jobs_of(gpu_sky)}
    gpu_sky.answer(jobs["air"])
    gpu_sky.answer(jobs["cube"])
    assert gpu_sky.kinds_taken() == [AirChanged, BackgroundChanged]


def test_a_job_that_failed_unwanted_is_made_up_for(gpu_sky: SkyOnBus) -> None:
    """Who went indoors before it failed, and comes out when the GPU is chosen anew, has air."""
    gpu_sky.eye(0.0, 20_000.0)
    (job,) = jobs_of(gpu_sky)
    gpu_sky.want_no_more(AirChanged)
    gpu_sky.answer(job, error="out of memory")
    gpu_sky.set("cube_device", "cpu")
    gpu_sky.set("cube_device", "gpu")
    gpu_sky.want(AirChanged)
    assert len(jobs_of(gpu_sky)) == 1


@pytest.mark.parametrize("hindrance", ["nobody runs GPU jobs", "the GPU failed"])
def test_where_the_gpu_does_not_serve_the_cpu_does(gpu_sky: SkyOnBus, hindrance: str) -> None:
    """Air is there all the same, and the counters say why the GPU had nothing to do."""
    if hindrance == "nobody runs GPU jobs":
        gpu_sky.want_no_more(GpuJob)
    gpu_sky.eye(0.0, 20_000.0)
    if hindrance == "the GPU failed":
        (job,) = jobs_of(gpu_sky)
        gpu_sky.answer(job, error="out of memory")
    (volume,) = air_of(gpu_sky)
    assert volume is not None
    assert isinstance(volume.light, Array)
    assert gpu_sky.counters.skipped[f"GpuJob: {hindrance}"] == 1

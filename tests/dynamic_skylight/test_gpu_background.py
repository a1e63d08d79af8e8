"""DynamicSkyLight with the setting `cube_device` on "gpu": who computes, and what is shown."""

from pathlib import Path

import msgspec
import numpy as np
import pytest
from dynamic_skylight.module import DynamicSkyLight
from dynamic_skylight.settings import DynamicSkyLightSettings
from sky_link import NOON, PRAGUE, FakeLink, tell, want

from vrut_lite.array import Array
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.daylight.sun import SunMoved
from vrut_lite.errors import UserError
from vrut_lite.gpu_job import GpuJob, GpuTexture
from vrut_lite.kernel.messages import JobResult, SetClock, SetSetting
from vrut_lite.kernel.settings import change

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.fixture
def link():
    """Holds both slots; somebody runs GPU jobs, and somebody wants a background."""
    link = FakeLink("sun", "sky")
    want(link, GpuJob)
    want(link, BackgroundChanged)
    return link


@pytest.fixture
def module(link):
    """At noon in Prague, on the GPU."""
    module = DynamicSkyLight(link, DynamicSkyLightSettings(cube_device="gpu"))
    tell(module, link, NOON)
    tell(module, link, PRAGUE)
    link.posted.clear()
    return module


def move_sun(module, link, **changed):
    tell(module, link, msgspec.structs.replace(link.last(SunMoved), **changed))


def set_turbidity(module, value):
    module.settings = change(module.settings, "dynamic_skylight", "turbidity", value)
    module.settings_changed("turbidity")


def finish(module, link, job, **outcome):
    texture = GpuTexture(size=job.size, format=job.format, recipe=job.recipe)
    result = {"value": texture, **outcome}
    tell(module, link, JobResult(module=job.module, job=job.job, **result))


def test_the_job_is_posted_and_its_texture_becomes_the_background(module, link):
    """256 texels unless a size is asked for; nothing is read back; the ground is said at once."""
    move_sun(module, link)
    (job,) = link.posted
    assert (job.size, job.output, job.format, job.read_back) == (256, "cube", "rgba16f", False)
    finish(module, link, job)
    background = link.posted[-1]
    assert background.cube == GpuTexture(size=256, format="rgba16f", recipe=job.recipe)
    assert np.log2(background.radiance_scale) % 1 == 0
    assert min(background.ground_radiance_rgb) > 0.0
    assert module.ledger.done == {"SunMoved": 1, "GpuJob": 1, "BackgroundChanged": 1}


def test_a_texture_read_from_a_journal_serves_too(module, link):
    """On replay a job's result is plain fields: the same background must be said."""
    move_sun(module, link)
    (job,) = link.posted
    finish(module, link, job, value={"size": 256, "format": "rgba16f", "recipe": job.recipe})
    assert link.posted[-1].cube == GpuTexture(size=256, format="rgba16f", recipe=job.recipe)


def test_where_nobody_runs_jobs_the_cpu_serves(module, link):
    """As in `vrut-lite sky`, whose kernel has no GL owner; when one comes, it takes over."""
    del link.demands[GpuJob]
    want(link, BackgroundChanged, size=16)
    move_sun(module, link)
    assert isinstance(link.posted[-1].cube, Array)
    assert module.ledger.skipped["GpuJob: nobody runs GPU jobs"] == 1
    want(link, GpuJob)
    tell(module, link, link.demands[GpuJob])
    assert isinstance(link.posted[-1], GpuJob)


def test_twilight_is_the_cpus(module, link):
    """Below the blend the sky is not the formula's alone."""
    want(link, BackgroundChanged, size=16)
    x, z = 0.6, 0.8
    move_sun(module, link, direction=(x, 0.0, z), apparent_elevation_rad=0.0)
    assert isinstance(link.posted[-1].cube, Array)
    assert module.ledger.skipped["GpuJob: twilight"] == 1


def test_a_failed_job_is_told_and_the_cpu_serves(module, link):
    """The user asked for the GPU and must hear that it fails, and see a sky all the same."""
    want(link, BackgroundChanged, size=16)
    move_sun(module, link)
    with pytest.raises(UserError, match="no such shader"):
        finish(module, link, link.posted[-1], value=None, error="no such shader")
    assert isinstance(link.posted[-1].cube, Array)
    set_turbidity(module, 5.0)
    assert isinstance(link.posted[-1].cube, Array)
    module.settings_changed("cube_device")
    assert isinstance(link.posted[-1], GpuJob)


def test_a_late_result_does_not_replace_a_newer_sky(module, link):
    """The order of answers is not the order of questions."""
    move_sun(module, link)
    set_turbidity(module, 5.0)
    first, second = link.posted
    finish(module, link, second)
    assert len(link.posted) == 3
    finish(module, link, first)
    assert len(link.posted) == 3
    assert module.ledger.skipped["GpuJob outdated"] == 1


def test_back_on_the_cpu_a_late_result_is_nothing(module, link):
    """The CPU's sky is the newer one."""
    want(link, BackgroundChanged, size=16)
    move_sun(module, link)
    job = link.posted[-1]
    module.settings = change(module.settings, "dynamic_skylight", "cube_device", "cpu")
    module.settings_changed("cube_device")
    count = len(link.posted)
    finish(module, link, job)
    assert len(link.posted) == count


@pytest.mark.long
@pytest.mark.gl
def test_a_frame_is_the_same_from_both_devices():
    """The picture must not tell where its sky was made: 2e-3 of radiance (two float16 steps)."""
    from vrut_lite.host import Host

    pictures = {}
    with Host(cube_size=256) as host:
        host.load(str(SCENES / "sundial.glb"))
        camera = MoveCamera(eye_m=(0.0, 1.0, 8.0), target_m=(0.0, 3.0, 0.0))
        host.inject(SetClock(instant=NOON.instant), PRAGUE, camera)
        for device in ("cpu", "gpu", "cpu"):
            host.inject(SetSetting(module="dynamic_skylight", name="cube_device", value=device))
            pictures[device] = host.draw().radiance
            cube = host.kernel.last(BackgroundChanged).cube
            assert isinstance(cube, GpuTexture if device == "gpu" else Array)
        for turbidity in (2.0, 4.0, 6.0):
            host.inject(
                SetSetting(module="dynamic_skylight", name="turbidity", value=turbidity),
                SetSetting(module="dynamic_skylight", name="cube_device", value="gpu"),
            )
            again = host.draw().radiance
            host.inject(SetSetting(module="dynamic_skylight", name="cube_device", value="cpu"))
            np.testing.assert_allclose(again, host.draw().radiance, rtol=2e-3)
    np.testing.assert_allclose(pictures["gpu"], pictures["cpu"], rtol=2e-3)

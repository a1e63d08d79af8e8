"""DynamicSkyLight with the setting `cube_device` on "gpu"; see also tests/test_sky_contract.py."""

from pathlib import Path

import numpy as np
import pytest
from dynamic_skylight.module import DynamicSkyLight
from noon_in_prague import PRAGUE, clock

from vrut_lite.array import Array
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_job import GpuJob, GpuTexture
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.testing.sky_on_bus import SkyOnBus

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.fixture
def sky():
    """On the GPU, with somebody to run its jobs and somebody who wants a background."""
    sky = SkyOnBus(DynamicSkyLight, cube_device="gpu")
    sky.want(GpuJob)
    sky.want(BackgroundChanged)
    return sky


def test_the_ground_and_the_scale_are_known_before_the_texture(sky):
    """256 texels unless a size is asked for; nothing is read back."""
    sky.sun(60.0)
    (job,) = sky.taken()
    assert (job.size, job.output, job.format, job.read_back) == (256, "cube", "rgba16f", False)
    sky.answer(job)
    (background,) = sky.taken()
    assert background.cube == GpuTexture(size=256, format="rgba16f", recipe=job.recipe)
    assert np.log2(background.radiance_scale) % 1 == 0
    assert min(background.ground_radiance_rgb) > 0.0


def test_twilight_is_the_cpus(sky):
    """Below the blend the CPU computes the sky, because the GPU has the formula alone."""
    sky.sun(0.0)
    (background,) = sky.taken()
    assert isinstance(background.cube, Array)
    assert sky.counters.skipped["GpuJob: an hour for the CPU"] == 1


def test_back_on_the_cpu_a_late_texture_is_not_shown(sky):
    """The CPU's sky is the newer one; chosen again, the GPU is asked again."""
    sky.sun(60.0)
    (job,) = sky.taken()
    sky.set("cube_device", "cpu")
    assert sky.kinds_taken() == [BackgroundChanged]
    sky.answer(job)
    assert sky.taken() == []
    assert sky.counters.skipped["GpuJob outdated"] == 1
    sky.set("cube_device", "gpu")
    assert sky.kinds_taken() == [GpuJob]


@pytest.mark.long
@pytest.mark.gl
def test_a_frame_is_the_same_from_both_devices():
    """The picture must not tell where its sky was made: 2e-3 of radiance (two float16 steps)."""
    from vrut_lite.host import Host

    pictures = {}
    with Host(cube_size=256) as host:
        host.load(str(SCENES / "sundial.glb"))
        camera = MoveCamera(eye_m=(0.0, 1.0, 8.0), target_m=(0.0, 3.0, 0.0))
        host.inject(clock(), PRAGUE, camera)
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

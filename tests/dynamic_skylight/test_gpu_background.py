"""DynamicSkyLight with the setting `cube_device` on "gpu"; see also tests/test_sky_contract.py."""

from pathlib import Path

import numpy as np
import pytest
from card_stage import apart
from dynamic_skylight.daylight import Daylight
from dynamic_skylight.gpu_twilight import gpu_twilight_job
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


@pytest.mark.gl
@pytest.mark.parametrize("size", [33, 64])
@pytest.mark.parametrize("sun_deg", [0.45, 0.0, -1.0, -2.4, -3.0, -8.0, -17.0, -30.0])
def test_twilight_is_the_processors(compute, sun_deg, size):
    """In single precision on both: 5e-6 of the larger of a texel and a hundredth of the largest."""
    light = Daylight(3.0, (0.1, 0.2, 0.3), "air", np.radians(sun_deg), 0.7, 0.0)
    asked = light.sky, 0.7, light.ground_rgb, size
    job, scale = gpu_twilight_job("test", "cube", *asked, format="rgba32f", read_back=True)
    card, processor = scale * compute(job), light.background(size)
    assert card.min() > 0.0
    assert apart(card, processor) < 5e-6


def test_the_scale_of_twilight_leaves_room(sky):
    """In half precision no texel overflows, and the brightest keeps all its bits."""
    for sun_deg in (0.0, -2.0, -6.0, -20.0):
        light = Daylight(3.0, 0.1, "air", np.radians(sun_deg), 0.7, 0.0)
        _, scale = gpu_twilight_job("test", "cube", light.sky, 0.7, light.ground_rgb, 16)
        assert 2.0**12 < light.background(64).max() / scale < 2.0**15


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

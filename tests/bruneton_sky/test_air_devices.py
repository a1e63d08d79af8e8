"""A frame through Bruneton's air, filled by the CPU and by the GPU."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
import trimesh
from long_parameters import mostly_long

from vrut_lite.array import Array
from vrut_lite.kernel.messages import ChooseSlot, SetClock, SetSetting
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.picture import Resize, SetExposure
from vrut_lite.messages.place import SetPlace

pytestmark = pytest.mark.gl
NOON = datetime(2026, 6, 21, 11, tzinfo=UTC)
EVENING = datetime(2026, 6, 21, 18, 30, tzinfo=UTC)
DUSK = datetime(2026, 1, 3, 16, 0, tzinfo=UTC)


@pytest.fixture(scope="module")
def walls(tmp_path_factory):
    """Things from 50 m to 3 km away, on a ground."""
    boxes = [trimesh.creation.box((4000.0, 0.1, 8000.0))]
    for metres, aside in ((50.0, -0.6), (400.0, 0.2), (3000.0, 0.5)):
        box = trimesh.creation.box((0.4 * metres, 0.5 * metres, 0.1 * metres))
        box.apply_translation((aside * metres, 0.25 * metres, -metres))
        boxes.append(box)
    path = tmp_path_factory.mktemp("walls") / "walls.glb"
    trimesh.Scene(boxes).export(path)
    return path


def setting(name, value, module="bruneton_sky"):
    return SetSetting(module=module, name=name, value=value)


@pytest.fixture(scope="module")
def host(walls):
    from vrut_lite.host import Host

    with Host(cube_size=64) as host:
        host.load(str(walls))
        host.inject(
            ChooseSlot(slot="sky", module="bruneton_sky"),
            SetPlace(latitude_deg=50.1, longitude_deg=14.4),
            Resize(width_px=96, height_px=60),
        )
        yield host


@pytest.mark.long
@pytest.mark.parametrize("shafts", mostly_long([False, True], bool))
@pytest.mark.parametrize("instant", mostly_long([NOON, EVENING], EVENING.__eq__))
@pytest.mark.parametrize("height_m", mostly_long([1.7, 900.0, 2e5], (1.7).__eq__))
def test_pictures_agree_whether_cpu_or_gpu_filled_the_air(host, height_m, instant, shafts):
    """Through fog, from the ground, from a hill's height and from above the air: displayed values
    within one step of 255, radiance within 1e-3 (the CPU's air is rounded to half precision)."""
    down = 0.0 if height_m < 10.0 else 0.5 * height_m
    host.inject(
        SetClock(instant=instant),
        setting("fog_visibility_m", 3000.0),
        setting("light_shafts", shafts, "scene"),
        SetExposure(mode="manual", ev100=13.0),
        MoveCamera(eye_m=(0.0, height_m, 0.0), target_m=(0.0, height_m - down, -1000.0)),
    )
    pictures = {}
    for device in ("cpu", "gpu"):
        host.inject(setting("cube_device", device))
        pictures[device] = host.draw()
        air = host.kernel.last(AirChanged)
        assert isinstance(air.volume.light, GpuTexture if device == "gpu" else Array)
    cpu, gpu = pictures["cpu"], pictures["gpu"]
    steps = np.abs(cpu.display.astype(int) - gpu.display)
    assert steps.max() <= 1
    np.testing.assert_allclose(gpu.radiance, cpu.radiance, rtol=1e-3, atol=1e-5)


def test_pictures_of_a_moonlit_dusk_agree(host):
    """The sun is 7 degrees down and the full moon as far up: its shadows are cast, and both
    light the air, which is one texture on a card. Seven minutes later, and by night, too."""
    host.inject(
        setting("fog_visibility_m", 3000.0),
        setting("light_shafts", False, "scene"),
        SetExposure(mode="manual", ev100=1.0),
        MoveCamera(eye_m=(0.0, 1.7, 0.0), target_m=(0.0, 1.7, -1000.0)),
    )
    bodies = []
    for minutes in (0, 7, 300):
        host.inject(SetClock(instant=DUSK + timedelta(minutes=minutes)))
        pictures = {}
        for device in ("cpu", "gpu"):
            host.inject(setting("cube_device", device))
            pictures[device] = host.draw()
            volume = host.kernel.last(AirChanged).volume
            assert isinstance(volume.light, GpuTexture if device == "gpu" else Array)
        cpu, gpu = pictures["cpu"], pictures["gpu"]
        assert np.abs(cpu.display.astype(int) - gpu.display).max() <= 1
        rounded = 1e-3 * cpu.radiance.max()
        np.testing.assert_allclose(gpu.radiance, cpu.radiance, rtol=2e-3, atol=rounded)
        assert cpu.display.max() > 20
        bodies.append(1 if volume.second is None else 2)
    assert bodies == [2, 2, 1]


@pytest.mark.long
def test_air_of_the_gpu_follows_the_sun(host):
    """Each hour has the air of its own job, not that of the hour before."""
    pictures = {}
    host.inject(setting("light_shafts", False, "scene"), SetExposure(mode="manual", ev100=13.0))
    for device in ("gpu", "cpu"):
        host.inject(setting("cube_device", device))
        for instant in (NOON, EVENING, NOON):
            host.inject(SetClock(instant=instant))
            pictures[device, instant] = host.draw().display.astype(int)
    for instant in (NOON, EVENING):
        assert np.abs(pictures["gpu", instant] - pictures["cpu", instant]).max() <= 1
    assert np.abs(pictures["gpu", NOON] - pictures["gpu", EVENING]).max() > 20

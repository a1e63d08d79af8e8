"""Clouds in a card's cube of the sky beside those of the processor's."""

from datetime import UTC, datetime, timedelta

import msgspec
import numpy as np
import pytest
from card_stage import CARD, SkyStage
from cloud_stage import rough_layer
from clouds.card_cube import cloud_passes
from clouds.layer import cloud_layer
from clouds.model.cloud_layers import clear_light
from clouds.module import Clouds
from clouds.settings import Layer
from clouds.sky_under_clouds import sky_behind_clouds
from dynamic_skylight.module import DynamicSkyLight
from light_messages import clear_sky_light, light_messages
from night_sky.module import NightSky

from vrut_lite.array import Array
from vrut_lite.atmosphere.haze_layer import HazeLayer
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.kernel.messages import JobResult, SetClock, SetSetting
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.sky import BackgroundChanged, SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.sky.sky_sum import SkySum

SIZE = 32
UP = texel_directions(SIZE)[..., 1] > 0.0
SUN = (0.6, 0.8, 0.0)
PRAGUE = SetPlace(latitude_deg=50.08, longitude_deg=14.44)
NOON = datetime(2026, 6, 21, 11, tzinfo=UTC)
EVENING = datetime(2026, 6, 21, 20, tzinfo=UTC)
FULL_MOON = datetime(2026, 1, 3, 23, tzinfo=UTC)
# Starts the cube with the numbers of a buffer.
GIVEN = """#version 430
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) writeonly uniform imageCube sky;
layout(std430, binding = 0) restrict readonly buffer Given { vec4 given[]; };
void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    int size = imageSize(sky).x;
    if (any(greaterThanEqual(at.xy, ivec2(size)))) return;
    imageStore(sky, at, given[(at.z * size + at.y) * size + at.x]);
}
"""


def of_genus(genus, coverage, **changed):
    usual = {"base_m": 1200.0, "thickness_m": 1200.0, "extinction_per_m": 0.02} | changed
    wind = {"wind_speed_m_s": 0.0, "wind_azimuth_deg": 0.0}
    return cloud_layer(Layer(genus, coverage, **usual, **wind), seed=3)


def heaps():
    return of_genus("Cu", 0.4)


def ice():
    return of_genus("Ci", 0.5, base_m=9000.0, thickness_m=800.0, extinction_per_m=8e-4)


LAYERS = {
    "rough": lambda: (rough_layer(base_m=900.0),),
    "heaps": lambda: (heaps(),),
    "a sheet": lambda: (of_genus("St", 0.95, base_m=400.0, thickness_m=500.0),),
    "ice behind heaps": lambda: (heaps(), ice()),
}


@pytest.mark.gl
@pytest.mark.parametrize("eye_m", [(0.0, 0.0, 0.0), (340.0, 2.0, -120.0)])
@pytest.mark.parametrize("kind", LAYERS)
def test_clouds_of_both_devices_are_the_same(compute, kind, eye_m):
    """The same samples: 1e-3 of the larger of a texel and a hundredth of the largest, in 99.8 % of
    texels. In the others a step of the march began on the other side of a cloud's edge."""
    layers, rng = LAYERS[kind](), np.random.default_rng(1)
    clear = np.array([2.0, 3.0, 5.0]) * rng.uniform(0.5, 1.5, (6, SIZE, SIZE, 3))
    parts = clear_sky_light(*light_messages(np.full((6, 8, 8, 3), 4.0), SUN, (90.0, 80.0, 70.0)))
    sun = msgspec.structs.replace(parts.key_light, haze=(HazeLayer(1200.0, (0.2,) * 3),))
    light = clear_light(sun, parts.ambient.irradiance_sh_rgb.values, (0.0, 0.0, 0.0))
    texels = np.concatenate([clear / 4.0, np.ones((6, SIZE, SIZE, 1))], axis=-1)
    groups = (-(-SIZE // 8), -(-SIZE // 8), 6)
    job = GpuJob(
        module="test",
        job="cube",
        compute_shader=GIVEN,
        uniforms={},
        output="cube",
        size=SIZE,
        format="rgba32f",
        groups=groups,
        read_back=True,
        buffers=((0, Array(texels.astype(np.float32).reshape(-1, 4))),),
        then=cloud_passes(layers, light, eye_m, SIZE, 4.0),
        scratch=2,
    )
    card, processor = 4.0 * compute(job), clear.copy()
    processor[UP] = sky_behind_clouds(layers, light, clear, UP, eye_m)
    assert np.mean(np.abs(processor / clear - 1.0)[UP] > 0.05) > 0.3
    np.testing.assert_allclose(card[~UP], clear[~UP], rtol=1e-6)
    assert np.isfinite(card).all()
    assert card.min() > 0.0
    far = np.abs(card - processor) / np.maximum(processor, 1e-2 * processor.max())
    assert np.quantile(far[UP].max(axis=-1), 0.998) < 1e-3
    assert far.max() < 0.1


class CloudyStage(SkyStage):
    """A day's and a night's sky with clouds, and who wants their sum."""

    def __init__(self, owner=None, size=SIZE, encoding="", tried=CARD, instant=NOON):
        super().__init__(DynamicSkyLight, NightSky, Clouds, SkySum, owner=owner, tried=tried)
        # Light as fine as the cube, so that sums of both devices have the same texels.
        self.tell(PRAGUE, SetClock(instant=instant))
        self.tell(MoveCamera(eye_m=(0.0, 1.7, 0.0), target_m=(0.0, 1.7, -1.0)))
        self.want(SkyLightChanged, size, encoding)
        self.want(SkyRadianceChanged, size)
        self.tell(SetSetting(module="clouds", name="coverage", value=0.5))

    @property
    def light(self):
        return self.kernel.last(SkyLightChanged)

    @property
    def choice(self):
        return self.module("sky_sum").devices.get("sky with clouds")

    @property
    def skipped(self):
        return self.module("sky_sum").counters.skipped


@pytest.mark.gl
@pytest.mark.parametrize("instant", [NOON, EVENING, FULL_MOON])
def test_a_cards_sky_with_clouds_is_the_processors(gl_owner, instant):
    """By day, in twilight and by moonlight; the card's clear sky stays on the card, no cube of the
    background is made by the processor, and all other parts are the same."""
    card, processor = CloudyStage(gl_owner, instant=instant), CloudyStage(instant=instant)
    light, other = card.light, processor.light
    assert isinstance(light.background.cube, GpuTexture)
    assert isinstance(card.kernel.last(BackgroundChanged).cube, GpuTexture)
    assert isinstance(other.background.cube, Array)
    assert card.choice.on_card
    assert light.layers == other.layers == ("cloud layer",)
    assert light.key_light == other.key_light
    assert light.ambient == other.ambient
    assert light.radiance == other.radiance
    np.testing.assert_allclose(
        light.background.ground_radiance_rgb, other.background.ground_radiance_rgb, rtol=1e-3
    )
    found, expected = card.radiance(light.background), processor.radiance(other.background)
    assert np.isfinite(found).all()
    assert found.min() >= 0.0
    far = (np.abs(found - expected) / np.maximum(expected, 1e-2 * expected.max())).max(axis=-1)
    # Two roundings to float16 of the processor's, and the march's own.
    assert np.quantile(far, 0.998) < 2e-3
    for stage in (card, processor):
        assert stage.faults == []
        stage.close()


@pytest.mark.gl
def test_another_clear_texture_needs_no_other_sum(gl_owner):
    """The same hour again posts nothing; a moved sun one sum, with the texture of its own sky."""
    stage = CloudyStage(gl_owner)
    sums = len([m for m in stage.heard if isinstance(m, SkyLightChanged)])
    stage.tell(SetClock(instant=NOON))
    assert len([m for m in stage.heard if isinstance(m, SkyLightChanged)]) == sums
    stage.tell(SetClock(instant=NOON + timedelta(hours=1)))
    last = [job for job in stage.jobs if job.module == "sky_sum"][-1]
    assert last.reads == stage.kernel.last(BackgroundChanged).cube
    assert stage.light.background.cube.recipe == last.recipe
    stage.tell(SetSetting(module="clouds", name="coverage", value=0.0))
    assert stage.light.layers == ()
    assert stage.light.background is stage.kernel.last(BackgroundChanged)
    assert stage.choice is None
    stage.close()


def test_auto_makes_as_large_a_cube_as_two_milliseconds_allow():
    """A march takes 160 trial pixels a texel; on a slow card clouds are the processor's, and so is
    the clear sky behind them, though without clouds it is the card's."""
    stage = CloudyStage(size=None, tried=None)
    stage.want(GpuJob)
    for trial_ns, edge in ((0.005, 512), (0.02, 256), (1.0, 0), (0.1, 128), (30.0, 0)):
        stage.tell(RendererTried(renderer="r", trial_ns=trial_ns))
        if not edge:
            assert not stage.choice.on_card
            assert isinstance(stage.kernel.last(BackgroundChanged).cube, Array)
            continue
        clear = [job for job in stage.jobs if job.module == "dynamic_skylight"][-1]
        if stage.jobs[-1] is clear:
            texture = GpuTexture(size=clear.size, format="rgba32f", recipe=clear.recipe)
            stage.tell(JobResult(module="dynamic_skylight", job="cube", value=texture))
        assert stage.choice.on_card
        assert (stage.jobs[-1].module, stage.jobs[-1].size) == ("sky_sum", edge)
        assert clear.size > edge
    assert stage.choice.why.endswith("of 2 ms, trial 30 ns")
    stage.close()


def test_who_reads_numbers_gets_the_processors_sum():
    """A demand with an encoding, an eye high up, a software renderer, and a failed card."""
    stage = CloudyStage(encoding="float16", tried=None)
    stage.tell(CARD)
    stage.want(GpuJob)
    assert stage.choice.why == "its numbers are read here"
    assert isinstance(stage.light.background.cube, Array)
    stage.want(SkyLightChanged, SIZE)
    texture = GpuTexture(size=SIZE, format="rgba32f", recipe=stage.jobs[-1].recipe)
    stage.tell(JobResult(module="dynamic_skylight", job="cube", value=texture))
    job = stage.jobs[-1]
    assert job.module == "sky_sum"
    stage.tell(JobResult(module="sky_sum", job="cube", error="out of memory"))
    assert stage.faults == [
        "the card could not add clouds to the sky (out of memory): the processor does"
    ]
    assert stage.choice.why == "the card failed"
    assert isinstance(stage.light.background.cube, Array)
    stage.close()


def test_a_texture_that_comes_late_is_not_shown():
    """Clouds that have gone meanwhile do not come back with their texture."""
    stage = CloudyStage(tried=None)
    stage.tell(CARD)
    stage.want(GpuJob)
    clear = GpuTexture(size=SIZE, format="rgba32f", recipe=stage.jobs[-1].recipe)
    stage.tell(JobResult(module="dynamic_skylight", job="cube", value=clear))
    job = stage.jobs[-1]
    assert job.module == "sky_sum"
    stage.tell(SetSetting(module="clouds", name="coverage", value=0.0))
    late = GpuTexture(size=job.size, format="rgba32f", recipe=job.recipe)
    stage.tell(JobResult(module="sky_sum", job="cube", value=late))
    assert stage.light.layers == ()
    assert stage.skipped["GpuJob outdated"] == 1
    stage.close()


def test_an_eye_aloft_sees_other_clouds_than_the_ground():
    """From 5 km the background is the processor's."""
    stage = CloudyStage(tried=None)
    stage.tell(CARD)
    stage.want(GpuJob)
    stage.tell(MoveCamera(eye_m=(0.0, 5e3, 0.0), target_m=(0.0, 5e3, -1.0)))
    assert stage.choice.why == "the card has no program for it"
    assert isinstance(stage.light.background.cube, Array)
    stage.close()

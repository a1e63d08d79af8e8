"""The card's cube of twilight and of night beside the processor's, through the real kernel."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from bruneton_sky import background
from bruneton_sky.module import BrunetonSky
from card_stage import CARD, SkyStage, apart
from dynamic_skylight.module import DynamicSkyLight
from night_sky.module import NightSky

from vrut_lite.array import Array
from vrut_lite.kernel.messages import ChooseSlot, SetClock, SetSetting
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.night import NightLightChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import SunMoved

SIZE = 48
PRAGUE = SetPlace(latitude_deg=50.08, longitude_deg=14.44)
FULL_MOON = datetime(2026, 1, 3, 23, tzinfo=UTC)
MOONLESS = datetime(2026, 10, 10, 22, tzinfo=UTC)
# The processor rounds to float16 by half a step of 4.9e-4: a sky's cube, and then the sum.
ROUNDED = 1e-3
SKIES = {"dynamic_skylight": DynamicSkyLight, "bruneton_sky": BrunetonSky}


class BothDevices:
    """The same kernel with a card and without one."""

    def __init__(self, owner, sky):
        modules = DynamicSkyLight, NightSky, *({BrunetonSky} & {SKIES[sky]})
        self.card, self.processor = SkyStage(*modules, owner=owner), SkyStage(*modules)
        for stage in self.stages:
            stage.tell(PRAGUE, ChooseSlot(slot="sky", module=sky))
            if sky == "bruneton_sky":
                stage.tell(SetSetting(module=sky, name="orders", value=2))
            stage.want(BackgroundChanged, SIZE)
        self.sky = sky

    @property
    def stages(self):
        return self.card, self.processor

    def tell(self, *messages):
        for stage in self.stages:
            stage.tell(*messages)
            assert stage.faults == []

    def cubes(self):
        """Radiance by the card, which made it, and by the processor."""
        by_card, by_processor = (s.kernel.last(BackgroundChanged) for s in self.stages)
        assert isinstance(by_card.cube, GpuTexture)
        assert isinstance(by_processor.cube, Array)
        # Where a card makes the sky-view table, a smaller one of the processor lights the ground.
        within = 1e-3 if self.sky == "bruneton_sky" else 1e-6
        np.testing.assert_allclose(
            by_card.ground_radiance_rgb, by_processor.ground_radiance_rgb, rtol=within
        )
        assert by_card.ground_through_air == by_processor.ground_through_air
        return tuple(stage.radiance() for stage in self.stages)

    def close(self):
        for stage in self.stages:
            stage.close()


@pytest.fixture(scope="module", params=SKIES)
def both(request, gl_owner):
    devices = BothDevices(gl_owner, request.param)
    yield devices
    devices.close()


@pytest.mark.gl
@pytest.mark.parametrize("instant", [FULL_MOON, MOONLESS, FULL_MOON - timedelta(hours=7.2)])
def test_a_cards_night_is_the_processors(both, instant):
    """Moonlight, airglow, starlight, zodiacal light and what is left of the sun's, per texel."""
    both.tell(MoveCamera(eye_m=(0.0, 1.7, 0.0), target_m=(0.0, 1.7, -1.0)))
    both.tell(SetClock(instant=instant))
    card, processor = both.cubes()
    assert np.isfinite(card).all()
    assert card.min() >= 0.0
    assert apart(card, processor) < ROUNDED


@pytest.mark.gl
def test_a_night_from_aloft_ends_at_its_own_horizon(both):
    """From 20 km the glow reaches 4.5 degrees below the level."""
    both.tell(MoveCamera(eye_m=(0.0, 2e4, 0.0), target_m=(0.0, 2e4, -1.0)))
    both.tell(SetClock(instant=MOONLESS))
    card, processor = both.cubes()
    assert apart(card, processor) < ROUNDED


@pytest.mark.gl
def test_a_day_from_aloft_is_the_processors_with_no_table_of_its(both, monkeypatch):
    """From 20 km, as the sun moves: the card makes the cube, and the table of each pixel's sky if
    the sky has one; the processor is not asked for it, nor are its numbers sent."""
    both.tell(MoveCamera(eye_m=(0.0, 2e4, 0.0), target_m=(0.0, 2e4, -1.0)))
    for hour in (8, 11, 16):
        with monkeypatch.context() as patch:
            patch.setattr(background, "sky_view", _refused)
            both.card.tell(SetClock(instant=datetime(2026, 6, 21, hour, tzinfo=UTC)))
        both.processor.tell(SetClock(instant=datetime(2026, 6, 21, hour, tzinfo=UTC)))
        assert both.card.faults == []
        card, processor = both.cubes()
        assert apart(card, processor) < ROUNDED
        views = [stage.kernel.last(BackgroundChanged).view for stage in both.stages]
        if both.sky == "bruneton_sky":
            assert [len(view.programs) for view in views] == [1, 0]


def _refused(*_):
    raise AssertionError("the processor made a table")


@pytest.mark.gl
def test_no_jump_from_day_to_night(both):
    """A sweep of an evening in steps of ten minutes: the card's sum follows the processor's."""
    both.tell(MoveCamera(eye_m=(0.0, 1.7, 0.0), target_m=(0.0, 1.7, -1.0)))
    suns, programs = [], set()
    for minutes in range(0, 200, 10):
        both.tell(SetClock(instant=datetime(2026, 6, 21, 18, 45, tzinfo=UTC)
                           + timedelta(minutes=minutes)))  # fmt: skip
        card, processor = both.cubes()
        assert apart(card, processor) < ROUNDED
        assert card.sum() == pytest.approx(processor.sum(), rel=2e-4)
        suns.append(np.degrees(both.card.kernel.last(SunMoved).elevation_rad))
        programs.add(len(both.card.jobs[-1].programs))
    assert max(suns) > 1.0
    assert min(suns) < -12.0
    # By day the sky's own; from sunset on the moon's and the glow's too. One sky makes a table
    # first.
    assert programs == ({2, 5} if both.sky == "bruneton_sky" else {1, 3})


@pytest.mark.gl
def test_without_a_night_module_twilight_is_one_program(gl_owner):
    """Hosek and Wilkie's sky from the last day to starlight, in sizes of any parity."""
    for size in (31, 64):
        stages = SkyStage(DynamicSkyLight, owner=gl_owner), SkyStage(DynamicSkyLight)
        for minutes in (0, 5, 10, 20, 60, 120, 300):
            instant = datetime(2026, 3, 20, 17, 0, tzinfo=UTC) + timedelta(minutes=minutes)
            for stage in stages:
                stage.tell(PRAGUE, SetClock(instant=instant))
                stage.want(BackgroundChanged, size)
            card, processor = (stage.radiance() for stage in stages)
            assert not stages[0].jobs[-1].then
            assert stages[0].jobs[-1].format == "rgba32f"
            assert card.min() > 0.0
            assert apart(card, processor) < ROUNDED
        for stage in stages:
            stage.close()


@pytest.mark.parametrize(("trial_ns", "edge"), [(0.1, 1024), (1.0, 512), (4.0, 256), (20.0, 0)])
def test_a_night_counts_the_work_of_all_its_programs(trial_ns, edge):
    """A moonlit night takes three programs, so its cube is smaller than a day's on a slow card."""
    stage = SkyStage(DynamicSkyLight, NightSky)
    stage.want(BackgroundChanged)
    stage.tell(PRAGUE, SetClock(instant=FULL_MOON))
    assert stage.kernel.last(NightLightChanged).moon is not None
    stage.kernel.inject(RendererTried(renderer="r", trial_ns=trial_ns))
    from vrut_lite.messages.gpu_job import GpuJob

    stage.want(GpuJob)
    chosen = stage.module("dynamic_skylight").devices["sky"]
    assert (chosen.on_card, chosen.edge) == (edge > 0, edge)
    assert [job.size for job in stage.jobs] == ([edge] if edge else [])
    stage.close()


def test_a_processor_renders_no_night_on_a_card():
    """llvmpipe is never a card."""
    assert CARD.trial_ns < 1.0
    stage = SkyStage(DynamicSkyLight, NightSky)
    stage.want(BackgroundChanged, 16)
    software = RendererTried(renderer="llvmpipe", trial_ns=0.1, is_software=True)
    stage.tell(PRAGUE, software, SetClock(instant=FULL_MOON))
    assert stage.module("dynamic_skylight").devices["sky"].why == ("a processor renders")
    stage.close()

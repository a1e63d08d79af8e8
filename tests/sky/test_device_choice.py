"""Card or processor for what both compute, by stated times of the renderer's trial."""

import pytest
from bruneton_sky.module import BrunetonSky
from dynamic_skylight.module import DynamicSkyLight

from vrut_lite.array import Array
from vrut_lite.kernel.messages import Demand
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.gpu_job import GpuJob, GpuTexture
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.sky.device_choice import BUDGET_S, CARD_EDGES, choose, choose_for_cube
from vrut_lite.testing.sky_on_bus import SkyOnBus

CARD = RendererTried(renderer="a card", trial_ns=0.1)
SLOWER = RendererTried(renderer="a laptop's", trial_ns=3.0)
LLVMPIPE = RendererTried(renderer="llvmpipe", trial_ns=90.0, is_software=True)


@pytest.fixture
def sky():
    """The default setting, somebody who runs GPU jobs, and somebody who wants a background."""
    sky = SkyOnBus(DynamicSkyLight)
    sky.want(GpuJob)
    sky.want(BackgroundChanged)
    return sky


def devices(sky):
    """Where the sky's products were computed last, and why."""
    return sky.kernel.seats[sky.name].module.devices


@pytest.mark.parametrize(
    ("trial_ns", "edge"), [(0.05, 1024), (1.2, 1024), (3.0, 512), (15.0, 256), (25.0, 0)]
)
def test_a_slower_renderer_gets_a_smaller_cube_and_at_last_none(trial_ns, edge):
    """The largest edge whose texels take 2 ms at most, at a quarter of a trial pixel each."""
    chosen = choose_for_cube("auto", RendererTried(renderer="r", trial_ns=trial_ns), 0.25)
    assert (chosen.on_card, chosen.edge) == (edge > 0, edge)
    if edge:
        assert 6 * edge**2 * 0.25 * trial_ns * 1e-9 <= BUDGET_S


def test_a_software_renderer_is_never_a_card():
    """However fast its many cores make the trial; nor is a machine without a renderer."""
    quick = RendererTried(renderer="llvmpipe", trial_ns=0.1, is_software=True)
    for tried in (quick, None):
        assert not choose("auto", tried, 1.0).on_card
        assert not choose_for_cube("auto", tried, 1.0).on_card


def test_a_setting_overrules_the_trial():
    """Both ways; a card that is too slow for the budget then makes its least cube."""
    slow = RendererTried(renderer="r", trial_ns=100.0)
    assert not choose_for_cube("cpu", CARD, 0.25).on_card
    assert choose_for_cube("gpu", slow, 0.25)[::2] == (True, CARD_EDGES[-1])
    assert choose("gpu", LLVMPIPE, 1e5).on_card


def test_each_product_has_its_own_choice():
    """At 15 ns a pixel the air's volume fits the budget, and the sky-view cube does not."""
    tried = RendererTried(renderer="r", trial_ns=15.0)
    sky = SkyOnBus(BrunetonSky, orders=2)
    for kind in (GpuJob, AirChanged, BackgroundChanged):
        sky.want(kind)
    sky.tell(tried)
    sky.sun(30.0)
    sky.eye(0.0, 20_000.0)
    jobs = [message.job for message in sky.taken() if isinstance(message, GpuJob)]
    assert jobs == ["air"]
    where = {name: chosen.device for name, chosen in devices(sky).items()}
    assert where == {"sky": "processor", "air": "card"}


def test_auto_makes_a_large_float_cube_on_a_card(sky):
    """1024 texels of single precision, nothing read back; 512 on a slower one."""
    sky.tell(CARD)
    sky.sun(60.0)
    (job,) = sky.taken()
    assert (job.size, job.format, job.read_back) == (1024, "rgba32f", False)
    sky.answer(job)
    (background,) = sky.taken()
    assert background.cube == GpuTexture(size=1024, format="rgba32f", recipe=job.recipe)
    assert devices(sky)["sky"].why == "0.16 of 2 ms, trial 0.1 ns"
    sky.tell(SLOWER)
    assert [job.size for job in sky.taken()] == [512]


def test_auto_is_the_processor_without_a_card(sky):
    """With no trial, as in a journal of an earlier version or without OpenGL, and on llvmpipe."""
    sky.sun(60.0)
    (background,) = sky.taken()
    assert isinstance(background.cube, Array)
    sky.tell(LLVMPIPE)
    assert sky.taken() == []
    sky.sun(50.0)
    assert sky.kinds_taken() == [BackgroundChanged]
    assert devices(sky)["sky"].why == "a processor renders"


def test_a_consumer_of_numbers_gets_an_array_also_beside_a_card(sky):
    """The path tracer, clouds and other processes read the cube; when they end, the card's serves
    again."""
    sky.tell(CARD)
    sky.sun(60.0)
    sky.taken()
    tracer = {"consumer": "tracer", "message": "BackgroundChanged"}
    sky.tell(Demand(**tracer, encoding="float16"))
    (background,) = sky.taken()
    assert isinstance(background.cube, Array)
    assert background.cube.shape[1] == 256
    sky.tell(Demand(**tracer, size=0))
    assert sky.kinds_taken() == [GpuJob]


def test_a_consumers_size_holds_on_the_card(sky):
    """Who names a size, as `Host(cube_size=...)`, gets it."""
    sky.tell(CARD)
    sky.want(BackgroundChanged, size=64)
    sky.sun(60.0)
    (job,) = sky.taken()
    assert job.size == 64

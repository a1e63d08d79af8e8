"""A graphics driver that is reset: another context shows the same picture again.

llvmpipe is never reset. Its context is destroyed under the GL thread, as a reset does, or its
driver's answer is that of a driver that was reset.
"""

import logging
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from house_fixtures import CARD_NS, PROCESSOR_NS
from lost_context import destroy_context, unbind_context

from vrut_lite.errors import UserError
from vrut_lite.host import Host
from vrut_lite.kernel.messages import ChooseSlot, SetClock, SetSetting
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.scene import LoadScene
from vrut_lite.render import context_loss, gl_owner
from vrut_lite.render.context_loss import ContextLostError
from vrut_lite.render.frame import Frame
from vrut_lite.render.gl_owner import GlOwner

pytestmark = pytest.mark.gl

SCENES = Path(__file__).parents[2] / "scenes"
PAVILION = str(SCENES / "pavilion.gltf")
NOON = datetime(2026, 6, 21, 11, tzinfo=UTC)
LIGHT = "light_transport"
BEGIN = (
    SetSetting(module=LIGHT, name="quality", value="draft"),
    SetSetting(module=LIGHT, name="texel_m", value=2.0),
    SetPlace(latitude_deg=50.0, longitude_deg=14.4),
    Resize(width_px=96, height_px=64),
    SetClock(instant=NOON),
)
RESET = 0x8255


def tell_of_reset(monkeypatch, times=1):
    """The driver answers so many questions with a reset; no two in a row, so that work begins."""
    left = [times]

    def answer():
        if left[0]:
            left[0] -= 1
            return RESET
        return 0

    monkeypatch.setattr(context_loss, "reset_status", answer)


@pytest.fixture(params=[CARD_NS, PROCESSOR_NS], ids=["as a card", "as a processor"])
def host(request):
    with Host(gl=GlOwner(request.param)) as host:
        host.inject(*BEGIN, LoadScene(path=PAVILION))
        host.settle()
        yield host


def same(one, other):
    return np.array_equal(one.display, other.display) and np.array_equal(
        one.radiance, other.radiance
    )


@pytest.mark.parametrize("still", [True, False])
def test_the_picture_comes_back_to_the_byte(host, caplog, still):
    """Stills and first moving pictures, with one line; and no module failed."""
    before = host.draw(still)
    assert before.radiance.any()
    destroy_context(host.gl)
    with caplog.at_level(logging.WARNING, "vrut_lite"):
        after = host.draw(still)
    assert same(before, after)
    lines = [record.getMessage() for record in caplog.records]
    assert len(lines) == 1
    assert lines[0].startswith("the graphics driver failed: its context is gone; llvmpipe")
    assert lines[0].endswith(" s")
    host.settle()
    host.draw(still)
    assert len(caplog.records) == 1


def test_a_moving_picture_that_is_lost_on_the_way_is_drawn_again():
    """A card's picture whose context goes between its begin and its end."""
    with Host(gl=GlOwner(CARD_NS)) as host:
        host.inject(*BEGIN, LoadScene(path=PAVILION))
        before = host.draw(still=False)
        assert before.radiance.any()
        own, lost = host._backend._draw, []

        def draw_and_lose(*arguments):
            drawn = own(*arguments)
            if not lost:
                lost.append(True)
                host.gl._thread.submit(unbind_context)
            return drawn

        host._backend._draw = draw_and_lose
        after = host.draw(still=False)
        assert lost
        assert host.gl.resets == 1
        assert same(before, after)


def test_a_reset_that_the_driver_tells_of_is_noticed(host, monkeypatch, caplog):
    """In the midst of work: it is done again, and its errors are nobody's fault."""
    before = host.draw()
    own, failed = Frame.draw, []

    def fail_once(self, *arguments):
        if not failed:
            failed.append(True)
            tell_of_reset(monkeypatch)
            raise RuntimeError("cannot create texture")
        return own(self, *arguments)

    monkeypatch.setattr(Frame, "draw", fail_once)
    with caplog.at_level(logging.WARNING, "vrut_lite"):
        after = host.draw()
    assert same(before, after)
    assert host.gl.resets == 1
    assert "it was reset for an unknown reason" in caplog.records[0].getMessage()
    host.settle()


def test_an_error_without_a_reset_is_no_reset(host, monkeypatch):
    """It is raised as ever, and the context stays."""
    host.draw()

    def fails(*_):
        raise RuntimeError("a fault of ours")

    monkeypatch.setattr(Frame, "draw", fails)
    with pytest.raises(RuntimeError, match="a fault of ours"):
        host.draw()
    assert host.gl.resets == 0


def test_products_of_the_card_are_computed_again():
    """Sky, air and light between surfaces, whose textures messages refer to: the same picture."""
    with Host(gl=GlOwner(CARD_NS), cube_size=64) as host:
        gpu = [
            SetSetting(module="bruneton_sky", name="cube_device", value="gpu"),
            SetSetting(module="bruneton_sky", name="orders", value=2),
            SetSetting(module=LIGHT, name="device", value="gpu"),
        ]
        host.inject(*BEGIN, *gpu, ChooseSlot(slot="sky", module="bruneton_sky"))
        host.load(PAVILION)
        before = host.draw()
        air = host.kernel.last(AirChanged).volume.light
        assert isinstance(air, GpuTexture)
        texture = air.opaque
        destroy_context(host.gl)
        after = host.draw()
        assert air.opaque is not texture
        assert same(before, after)


def test_a_job_under_way_is_answered_once():
    """A texture that was asked for when the context went is made in the next one."""
    with Host(gl=GlOwner(CARD_NS), cube_size=64) as host:
        host.inject(*BEGIN)
        host.load(PAVILION)
        host.draw()
        destroy_context(host.gl)
        sky = host.kernel.slots.holder("sky")
        host.inject(SetSetting(module=sky, name="cube_device", value="gpu"))
        host.settle()
        lost = host.draw()
        host.inject(SetSetting(module=sky, name="cube_device", value="cpu"))
        host.settle()
        assert np.abs(lost.display.astype(int) - host.draw().display).max() <= 1


def test_the_second_reset_within_a_minute_leads_to_a_processor(monkeypatch):
    """The first opens any device; modules hear of the other renderer once, and choose again."""
    asked = []
    own = gl_owner.open_context

    def noted(only_software=False):
        asked.append(only_software)
        return own(only_software)

    monkeypatch.setattr(gl_owner, "open_context", noted)
    with Host(gl=GlOwner()) as host:
        tried = []
        host.kernel.watch_admission(
            lambda message: tried.append(message) if isinstance(message, RendererTried) else None
        )
        host.inject(*BEGIN)
        host.load(PAVILION)
        before = host.draw()
        for _ in range(2):
            destroy_context(host.gl)
            assert same(host.draw(), before)
        assert asked == [False, False, True]
        host.settle()
        # The same llvmpipe each time: nothing to choose again.
        assert tried == []
        now_s = gl_owner.perf_counter()
        monkeypatch.setattr(gl_owner, "perf_counter", lambda: now_s + 61.0)
        destroy_context(host.gl)
        host.draw()
        assert asked[-1] is False


def test_another_renderer_is_a_fact_for_modules(monkeypatch):
    """A card is lost for good and a processor takes over: the trial of the latter is posted."""
    with Host(gl=GlOwner(CARD_NS)) as host:
        host.inject(*BEGIN)
        host.load(PAVILION)
        host.draw()
        host.gl._trial_ns = None
        destroy_context(host.gl)
        host.draw()
        host.settle()
        assert host.kernel.last(RendererTried).is_software
        assert host.gl.opened.device.choices.takes_over


def test_without_a_software_renderer_a_sentence_says_what_to_do(monkeypatch):
    """The second reset within a minute, where no software renderer is installed."""
    monkeypatch.setattr("vrut_lite.render.gl_choice.is_software", lambda _: False)
    owner = GlOwner(CARD_NS)
    try:
        owner.call(lambda context: context.info["GL_RENDERER"])
        destroy_context(owner)
        owner.call(lambda context: None)
        destroy_context(owner)
        with pytest.raises(UserError, match="install Mesa's llvmpipe"):
            owner.call(lambda context: None)
    finally:
        owner.close()


def test_a_picture_of_a_lost_context_has_no_radiance_any_more():
    """It is not read from another texture of the same name."""
    with Host(gl=GlOwner(CARD_NS)) as host:
        host.inject(*BEGIN)
        host.load(PAVILION)
        picture = host.draw(still=False)
        destroy_context(host.gl)
        host.draw(still=False)
        with pytest.raises(UserError, match="draw it again"):
            _ = picture.radiance


def test_work_that_is_lost_with_its_context_says_so(monkeypatch):
    """Who cannot begin again gets one sentence."""
    owner = GlOwner(CARD_NS)
    try:

        def lose(_):
            unbind_context()
            return 1

        with pytest.raises(ContextLostError, match="graphics driver failed: its context is gone"):
            owner.call(lose)
        assert owner.call(lambda context: context.buffer(b"1234").read()) == b"1234"
    finally:
        owner.close()

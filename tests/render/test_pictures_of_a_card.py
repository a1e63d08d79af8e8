"""A renderer that a trial finds quick draws one picture with several samples a pixel.

Any renderer does so when its trial's time is stated; what it draws is what a slow one draws.
"""

from datetime import UTC, datetime

import numpy as np
import pytest
import trimesh
from box_stage import show_box, sun_at, uniform_sky
from house_fixtures import CARD_NS
from scene_stage import light, look, look_finished
from stateful_backend import StatefulBackend

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import EnableModule, SetClock, SetSetting
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.picture import Resize, SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.pictures.display import developed
from vrut_lite.pictures.exposure import automatic_ev100, metered_ev100
from vrut_lite.pictures.luminance_histogram import counted, luminances_of

pytestmark = pytest.mark.gl
SUN = {"sun_direction": sun_at(35.0, 40.0), "sun_irradiance": (10.0, 9.0, 8.0)}
EYE, TARGET = (4.0, 3.0, 6.0), (0.0, 1.0, 0.0)


@pytest.fixture(scope="module")
def card_owner():
    from vrut_lite.render.gl_owner import GlOwner

    owner = GlOwner(CARD_NS)
    yield owner
    owner.close()


@pytest.fixture
def card(card_owner):
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    backend = PyrenderBackend(card_owner)
    yield StatefulBackend(backend, size_px=(160, 120))
    backend.close()


@pytest.mark.parametrize("still", [True, False])
def test_a_card_and_a_processor_draw_the_same_picture(card, shared_gl_backend, box_file, still):
    """But for pixels on edges, which have other samples: a tenth of this picture at most."""
    seen = []
    for backend in (card, shared_gl_backend(size_px=(160, 120))):
        show_box(backend, box_file)
        light(backend, uniform_sky(1.0), **SUN)
        seen.append(look(backend, EYE, TARGET, still=still))
    off = np.abs(seen[0].radiance / seen[1].radiance - 1.0).max(axis=-1)
    assert np.median(off) < 1e-4
    assert (off > 0.01).mean() < 0.1
    assert seen[0].ev100 == pytest.approx(seen[1].ev100, abs=0.02)
    apart = np.abs(seen[0].display.astype(int) - seen[1].display)
    assert np.median(apart) <= 1.0


def test_a_finished_still_is_added_on_the_card(card, shared_gl_backend, box_file):
    """As eight pictures that are read and added by the processor: the same numbers to 1e-6."""
    stills = []
    for backend in (card, shared_gl_backend(size_px=(160, 120))):
        show_box(backend, box_file)
        light(backend, uniform_sky(1.0), **SUN)
        backend.counters.done.clear()
        stills.append(look_finished(backend, EYE, TARGET))
        assert backend.counters.done["picture"] == 8
    np.testing.assert_allclose(stills[0].radiance, stills[1].radiance, rtol=1e-6, atol=1e-9)


def test_a_pixel_on_an_edge_is_the_mean_of_four_samples(card, box_file):
    """In linear radiance: quarters of the way from a black disc to 3."""
    show_box(card, box_file, albedo=0.0)
    light(card, uniform_sky(3.0))
    picture = look(card, (200.0, 20.0, 0.0), (200.0, 0.0, 0.0))
    np.testing.assert_allclose(np.unique(picture.radiance), np.arange(5) * 0.75, rtol=1e-6)


def test_another_exposure_of_a_cards_still_draws_nothing_anew(card, box_file):
    """Its radiance stays on the card."""
    show_box(card, box_file)
    light(card, uniform_sky(1.0), **SUN)
    first = look(card, EYE, TARGET)
    drawn = card.counters.done["picture"]
    card.change(exposure=SetExposure(mode="manual", ev100=first.ev100 + 1.0))
    darker = card.draw()
    assert card.counters.done["picture"] == drawn
    assert np.array_equal(darker.radiance, first.radiance)
    assert darker.display.mean() < first.display.mean()


# --- moving pictures -----------------------------------------------------------------------

_WAITS = ("glReadPixels", "glGetTexImage", "glGetBufferSubData", "glFinish", "glClientWaitSync")
ODD_SIZE = (161, 121)


def moving(card, **parts):
    """A moving picture after changes of the state."""
    card.change(**parts)
    return look(card, EYE, TARGET, still=False)


def test_a_moving_picture_reads_nothing_within_its_frame(card, card_owner, box_file, monkeypatch):
    """Nor waits, under a new sky too: each call that would is an error while it is drawn."""
    from OpenGL import GL

    show_box(card, box_file)
    light(card, uniform_sky(1.0), **SUN)
    moving(card)
    light(card, uniform_sky(2.0), **SUN)

    def refused(*_):
        raise AssertionError("the frame waits for the card")

    def drawn_without_waits(context):
        with monkeypatch.context() as patches:
            for name in _WAITS:
                patches.setattr(GL, name, refused)
            return card.backend._draw(context, card.state, False, None)

    drawn = card_owner.call(drawn_without_waits)
    while (taken := card_owner.call(lambda _: drawn.taken(card_owner.call))) is None:
        pass
    assert taken.display.shape == (120, 160, 3)


def test_the_cards_histogram_is_its_twins(card, box_file):
    """Bin by bin, but for pixels that a logarithm's rounding moves to the next bin."""
    show_box(card, box_file)
    light(card, uniform_sky(1.0), **SUN)
    picture = moving(card, size_px=ODD_SIZE)
    twin = counted(picture.radiance)
    assert picture.counts.sum() == twin.sum() == ODD_SIZE[0] * ODD_SIZE[1]
    apart = np.cumsum(picture.counts.astype(int) - twin.astype(int))
    assert np.abs(apart).max() <= 0.01 * twin.sum()


def test_automatic_exposure_is_that_of_the_picture_before(card, box_file):
    """One picture late; a scene's first picture is metered by itself."""
    show_box(card, box_file)
    light(card, uniform_sky(1.0))
    first = moving(card)
    assert first.ev100 == pytest.approx(
        automatic_ev100(first.radiance, card.state.white_card), abs=0.02
    )
    light(card, uniform_sky(2.0))
    late, settled = moving(card), moving(card)
    before = luminances_of(first.counts)
    assert late.ev100 == metered_ev100(before, card.state.white_card)
    assert settled.ev100 == pytest.approx(
        automatic_ev100(settled.radiance, card.state.white_card), abs=0.02
    )
    show_box(card, box_file)
    anew = moving(card)
    assert anew.ev100 == pytest.approx(settled.ev100, abs=0.02)


@pytest.mark.parametrize("size_px", [ODD_SIZE, (64, 3), (5, 7)])
def test_bytes_for_display_are_the_tone_mapped_radiance(card, box_file, size_px):
    """Row 0 at the top, of any size: as the CPU's tone map says, within dither and a step."""
    show_box(card, box_file)
    light(card, uniform_sky(1.0), **SUN)
    wish = SetExposure(mode="manual", ev100=10.0)
    picture = moving(card, size_px=size_px, exposure=wish)
    expected = developed(picture.radiance, wish).display
    assert picture.display.shape == expected.shape == (*size_px[::-1], 3)
    assert np.abs(picture.display.astype(int) - expected).max() <= 2


def test_a_pictures_radiance_is_its_own(card, box_file):
    """Read when it is asked for, also after later pictures."""
    show_box(card, box_file)
    pictures = []
    for level in (1.0, 2.0, 4.0):
        light(card, uniform_sky(level))
        pictures.append(moving(card))
    for level, picture in zip((1.0, 2.0, 4.0), pictures, strict=True):
        np.testing.assert_allclose(picture.radiance.max(), level, rtol=1e-3)


def test_radiance_that_left_the_card_is_refused_in_a_sentence(card_owner, box_file):
    """As of a picture that is kept beyond its host."""
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    backend = PyrenderBackend(card_owner)
    card = StatefulBackend(backend, size_px=(160, 120))
    show_box(card, box_file)
    light(card, uniform_sky(1.0))
    last = moving(card)
    backend.close()
    with pytest.raises(UserError, match="draw it again"):
        _ = last.radiance


def test_a_host_with_a_card_draws_the_skys_texture_by_itself(tmp_path):
    """With the shipped settings: 1024 texels of single precision, and the picture that a 256-texel
    cube of the processor gives, within 1 % but for pixels of the horizon."""
    from vrut_lite.host import Host
    from vrut_lite.render.gl_owner import GlOwner

    path = tmp_path / "box.glb"
    trimesh.creation.box((2, 2, 2)).export(path)
    with Host(gl=GlOwner(CARD_NS)) as host:
        host.inject(EnableModule(module="light_transport", enabled=False))
        host.load(str(path))
        host.inject(
            SetPlace(latitude_deg=50.0, longitude_deg=14.0),
            SetClock(instant=datetime(2026, 6, 21, 11, tzinfo=UTC)),
            MoveCamera(eye_m=EYE, target_m=(0.0, 3.0, 0.0)),
            Resize(width_px=96, height_px=64),
        )
        by_card = host.draw(still=False)
        cube = host.kernel.last(BackgroundChanged).cube
        assert (cube.size, cube.format) == (1024, "rgba32f")
        host.inject(SetSetting(module="dynamic_skylight", name="cube_device", value="cpu"))
        by_processor = host.draw(still=False)
        assert isinstance(host.kernel.last(BackgroundChanged).cube, Array)
        off = np.abs(by_card.radiance / by_processor.radiance - 1.0).max(axis=-1)
    assert (off > 0.01).mean() < 0.03

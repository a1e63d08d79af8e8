"""A renderer that a trial finds quick draws one picture with several samples a pixel.

Any renderer does so when its trial's time is stated; what it draws is what a slow one draws.
"""

import numpy as np
import pytest
from box_stage import show_box, sun_at, uniform_sky
from house_fixtures import CARD_NS
from scene_stage import light, look
from stateful_backend import StatefulBackend

from vrut_lite.messages.picture import SetExposure

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

"""Metering by a histogram of luminance, as of a picture that stays on a card."""

import numpy as np
import pytest

from vrut_lite.pictures.exposure import automatic_ev100, metered_ev100
from vrut_lite.pictures.luminance_histogram import BINS, counted, luminances_of


def pictures():
    """Radiances (n, 3) of a day with the sun's disc, of a room's window, of dusk, of black."""
    rng = np.random.default_rng(1)
    day = rng.lognormal(2.0, 1.0, 60_000)
    day[:40] = 2e7
    room = np.where(rng.random(60_000) < 0.2, 60.0, rng.lognormal(-1.0, 0.5, 60_000))
    dusk = rng.lognormal(-9.0, 1.5, 60_000)
    for name, values in {"day": day, "room": room, "dusk": dusk, "black": 0.0 * dusk}.items():
        yield pytest.param(np.repeat(values[:, None], 3, axis=1), id=name)


@pytest.mark.parametrize("look", ["eye", "exposure"])
@pytest.mark.parametrize("white", [0.0, 100.0])
@pytest.mark.parametrize("radiance", list(pictures()))
def test_a_histogram_meters_as_the_pixels_do(radiance, white, look):
    """Within 0.02 EV, a fifth of what is seen: bins are a 64th of a stop, ranks 8192."""
    exact = automatic_ev100(radiance, white, look)
    assert metered_ev100(luminances_of(counted(radiance)), white, look) == pytest.approx(
        exact, abs=0.02
    )


def test_pixels_that_are_no_numbers_do_not_count():
    """A broken pixel must not expose the picture; a picture without pixels has an exposure too."""
    counts = counted(np.array([[1.0, 1.0, 1.0], [np.nan] * 3, [np.inf] * 3, [0.0] * 3]))
    assert counts.sum() == 2
    assert np.isfinite(metered_ev100(luminances_of(np.zeros(BINS, np.uint32))))


def test_the_end_bins_take_what_lies_beyond():
    """No pixel is lost, however dark or bright."""
    counts = counted(np.array([[1e-30] * 3, [1e30] * 3]))
    assert (counts[0], counts[-1], counts.sum()) == (1, 1, 2)

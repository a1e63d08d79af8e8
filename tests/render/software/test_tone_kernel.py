"""Moving pictures are tone-mapped by a table as finished pictures are by their curves."""

import msgspec
import numpy as np
import pytest

from vrut_lite.messages.picture import SetExposure
from vrut_lite.pictures.display import developed
from vrut_lite.render.software.tone_kernel import tone_mapped


@pytest.mark.parametrize("curve", ["agx", "exponential", "none"])
def test_a_table_shows_colours_as_their_curve_does(curve):
    """From below zero to the sun's disc: at most a step of 255 apart, and no brighter."""
    random = np.random.default_rng(1)
    radiance = np.exp(random.uniform(-16.0, 8.0, (64, 96, 4))).astype(np.float32)
    radiance[0], radiance[1], radiance[2] = 0.0, 1e9, -1.0
    wish = SetExposure(mode="manual", ev100=7.0, tone_map=curve, white_temperature_k=5000.0)
    wish = msgspec.structs.replace(wish, night_look="exposure")
    wanted = developed(radiance[::-1, :, :3], wish).display.astype(int)
    toned = tone_mapped(radiance, 7.0, wish).view(np.uint8).reshape(64, 96, 4)[::-1].astype(int)
    off = toned[..., :3] - wanted
    assert np.abs(off).max() <= 1
    assert abs(off.mean()) < 0.02
    luma = wanted @ [0.2126, 0.7152, 0.0722]
    assert np.abs(toned[..., 3] - luma).max() < 2.0

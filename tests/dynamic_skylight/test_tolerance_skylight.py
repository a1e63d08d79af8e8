"""DynamicSkyLight at a tolerance: what it chooses, what it keeps, what it posts anew."""

from itertools import pairwise

import numpy as np
from dynamic_skylight.module import DynamicSkyLight
from dynamic_skylight.sun_step import RADIANCE_TOLERANCE
from dynamic_skylight.tolerance import FRONTS, HosekWilkieQuality, quality_for

from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE, SetTolerance, read_fronts
from vrut_lite.testing.sky_on_bus import SkyOnBus

LIGHT = (BackgroundChanged, KeyLightChanged, AmbientChanged)
GRID = np.geomspace(1e-4, 1.0, 81).tolist()


def test_the_default_is_unchanged():
    """256 texels, light from 64, a thousandth for an unfollowed sun, 1 % of air: the sizes that
    pictures and journals were made with before there was a tolerance."""
    assert quality_for(DEFAULT_TOLERANCE) == HosekWilkieQuality(256, 64, RADIANCE_TOLERANCE, 0.01)


def test_a_looser_tolerance_never_asks_for_more():
    """Over a grid of tolerances, knob by knob: fewer texels, longer steps."""
    chosen = [quality_for(tolerance) for tolerance in GRID]
    for tighter, looser in pairwise(chosen):
        assert looser.cube_size <= tighter.cube_size
        assert looser.light_size <= tighter.light_size
        assert looser.sun_change >= tighter.sun_change
        assert looser.altitude_change >= tighter.altitude_change
    assert chosen[0].cube_size > 4 * chosen[-1].cube_size


def test_fronts_fall():
    """More texels bring less error, or a size would be no choice."""
    for front in read_fronts(FRONTS).fronts.values():
        work, error = ([getattr(p, name) for p in front] for name in ("work", "error"))
        assert work == sorted(work)
        assert error == sorted(error, reverse=True)


def test_a_tolerance_makes_the_sky_anew():
    """A tighter one at once, with all light of the hour; the same again makes nothing."""
    sky = SkyOnBus(DynamicSkyLight)
    sky.want(*LIGHT)
    sky.sun(60.0)
    sizes = []
    for tolerance, posts in ((0.003, True), (0.003, False), (1.0, True)):
        sky.taken()
        sky.tell(SetTolerance(tolerance=tolerance))
        assert sky.kinds_taken() == (list(LIGHT) if posts else [])
        sizes.append(sky.last(BackgroundChanged).cube.shape[1])
        assert sizes[-1] == quality_for(tolerance).cube_size
    assert sizes[0] > 256 > sizes[-1]

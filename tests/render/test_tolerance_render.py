"""What of a frame follows the tolerance: how far the mirrored sky may lag behind the sky."""

from itertools import pairwise

import numpy as np
import pytest

from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE
from vrut_lite.render.light import SkyTexture
from vrut_lite.render.passes.specular_filter import CHANGE_SEEN, SpecularFilter, reflection_change


def test_the_default_is_unchanged():
    """Half a step of 8 bits, as before there was a tolerance."""
    assert reflection_change(DEFAULT_TOLERANCE) == CHANGE_SEEN


def test_a_looser_tolerance_never_filters_more():
    """A larger change goes unfollowed, and never more than half of a tight tolerance."""
    grid = np.geomspace(1e-4, 1.0, 61).tolist()
    for tighter, looser in pairwise(map(reflection_change, grid)):
        assert looser >= tighter
    assert all(reflection_change(tolerance) <= 0.5 * tolerance for tolerance in grid)


@pytest.mark.gl
def test_a_sky_within_it_is_not_filtered_again(gl_owner):
    """A sky that brightens by 1 % is filtered at 1 % of tolerance and not at 40 %; the counters
    say which."""

    def slices_for(context, tolerance):
        counters = WorkCounters()
        ours = SpecularFilter(context, counters)
        ours.change_seen = reflection_change(tolerance)
        skies = [
            context.texture_cube(
                (8, 8), 4, np.full((6, 8, 8, 4), v, np.float16).tobytes(), dtype="f2"
            )
            for v in (1.0, 1.01)
        ]
        for sky in skies:
            ours.update(SkyTexture(sky, 1.0, sky), None)
        for thing in (ours, *skies):
            thing.release()
        return counters

    tight, loose = (gl_owner.call(lambda c, t=t: slices_for(c, t)) for t in (0.01, 0.4))
    assert tight.done["reflection slice"] == 2 * loose.done["reflection slice"]
    assert loose.skipped["reflection: no change to be seen"] == 1

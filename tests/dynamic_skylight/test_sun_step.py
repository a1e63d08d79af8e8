"""Moves of the sun that nobody sees: the same picture for less work."""

import numpy as np
import pytest
from dynamic_skylight.sun_step import RADIANCE_TOLERANCE, sun_step_rad
from dynamic_skylight.twilight import sky_of_hour
from exact_cube import angles_to, world_sun
from noon_in_prague import PRAGUE, clock, sky_with_its_sun

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.kernel.messages import ChooseSlot
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved

LIGHT = (BackgroundChanged, KeyLightChanged, AmbientChanged)
UPPER = texel_directions(24)[texel_directions(24)[..., 1] > 0]


@pytest.mark.parametrize("elevation_deg", [-12, -6, -2, 0, 0.7, 1, 1.5, 3, 7, 10, 21, 45, 89])
@pytest.mark.parametrize(("turbidity", "albedo"), [(1.0, 0.1), (2.0, 0.0), (6.0, 1.0), (10.0, 0.0)])
def test_a_step_changes_no_texel_beyond_the_tolerance(turbidity, albedo, elevation_deg):
    """Up, down or aside by one step: at most 1e-3 of the larger of value and 1 % of the maximum."""
    elevation = np.radians(elevation_deg)
    step = sun_step_rad(elevation)
    moves = [(0.0, step), (0.0, -step), (step / np.cos(elevation), 0.0)]
    before = radiance(turbidity, albedo, elevation, 0.3)
    for azimuth_step, elevation_step in moves:
        after = radiance(turbidity, albedo, elevation + elevation_step, 0.3 + azimuth_step)
        allowed = RADIANCE_TOLERANCE * np.maximum(before, 1e-2 * before.max())
        assert np.all(np.abs(after - before) <= allowed)


def radiance(turbidity, albedo, elevation, azimuth):
    sky = sky_of_hour(turbidity, albedo, elevation)
    return sky.radiance(*angles_to(UPPER, world_sun(azimuth, elevation)))


@pytest.fixture
def sky():
    """Noon in Prague, its sky posted."""
    sky = sky_with_its_sun()
    sky.want(*LIGHT, size=16)
    sky.tell(clock(), PRAGUE)
    sky.taken()
    return sky


def shown(sky):
    background = sky.last(BackgroundChanged)
    return decode_float16(background.cube.values, background.radiance_scale)


def test_playing_in_real_time_makes_few_skies(sky):
    """A minute at one tick a second: the sun goes 0.25 deg, in steps of 0.01 at noon."""
    for second in range(1, 61):
        sky.tell(clock(second))
    posted = [kind for kind in sky.kinds_taken() if kind is not SunMoved]
    made = posted.count(BackgroundChanged)
    assert posted == list(LIGHT) * made
    assert made <= 26
    assert sky.counters.skipped["sun or eye moved unseen"] == 60 - made
    assert sky.counters.skipped["AmbientChanged unchanged"] == 60 - made


def test_the_picture_is_the_same_with_less_work(sky):
    """What is shown at any second is that second's sky, within the tolerance and rounding."""
    for second in range(1, 31):
        sky.tell(clock(second))
        fresh = sky_with_its_sun()
        fresh.want(*LIGHT, size=16)
        fresh.tell(clock(second), PRAGUE)
        exact = shown(fresh)
        allowed = (RADIANCE_TOLERANCE + 2**-10) * np.maximum(exact, 1e-2 * exact.max())
        assert np.all(np.abs(shown(sky) - exact) <= allowed)
    assert sky.counters.done["BackgroundChanged"] < 16


def test_small_moves_do_not_add_up(sky):
    """Each is counted from the sky that is shown, not from the last that was skipped."""
    first = sky.last(SunMoved)
    for second in range(1, 600):
        sky.tell(clock(second))
        shown_sun = np.array(sky.last(KeyLightChanged).direction)
        now = np.array(sky.last(SunMoved).direction)
        assert np.linalg.norm(now - shown_sun) <= sun_step_rad(first.apparent_elevation_rad)


def test_a_sun_on_the_horizon_is_followed_closely(sky):
    """While its visible share changes, so does the light: no move of the disc is skipped."""
    sky.tell(ChooseSlot(slot="sun", module="sun_and_eye"))
    sky.sun(0.0)
    sky.taken()
    sky.sun(0.0001)
    assert KeyLightChanged in sky.kinds_taken()


def test_another_turbidity_is_never_within_the_tolerance(sky):
    """Only the sun's moves are: a setting that somebody changed shows."""
    sky.set("turbidity", 3.0001)
    assert BackgroundChanged in sky.kinds_taken()

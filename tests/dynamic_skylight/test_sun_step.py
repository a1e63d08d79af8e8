"""Moves of the sun that nobody sees: the same picture for less work."""

from datetime import timedelta

import msgspec
import numpy as np
import pytest
from dynamic_skylight.module import DynamicSkyLight
from dynamic_skylight.settings import DynamicSkyLightSettings
from dynamic_skylight.sun_step import RADIANCE_TOLERANCE, sun_step_rad
from dynamic_skylight.twilight import sky_of_hour
from exact_cube import angles_to, world_sun
from sky_link import NOON, PRAGUE, SKY, FakeLink, tell, want

from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged, SunMoved
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.encoding import decode_float16

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
def link():
    link = FakeLink("sun", "sky")
    want(link, *SKY, size=16)
    return link


@pytest.fixture
def module(link):
    """Noon in Prague, its sky posted."""
    module = DynamicSkyLight(link, DynamicSkyLightSettings())
    tell(module, link, NOON)
    tell(module, link, PRAGUE)
    tell(module, link, link.last(SunMoved))
    return module


def play(module, link, seconds):
    later = msgspec.structs.replace(NOON, instant=NOON.instant + timedelta(seconds=seconds))
    tell(module, link, later)
    tell(module, link, link.last(SunMoved))


def shown(link):
    background = link.last(BackgroundChanged)
    return decode_float16(background.cube.values, background.radiance_scale)


def test_playing_in_real_time_makes_few_skies(module, link):
    """A minute at one tick a second: the sun goes 0.25 deg, in steps of 0.01 at noon."""
    for second in range(1, 61):
        play(module, link, second)
    made, skipped = module.ledger.done["BackgroundChanged"], module.ledger.skipped
    assert made == module.ledger.done["KeyLightChanged"]
    assert made <= 27
    assert skipped["sun within tolerance"] == skipped["BackgroundChanged unchanged"] == 61 - made
    assert skipped["AmbientChanged unchanged"] == 61 - made


def test_the_picture_is_the_same_with_less_work(module, link):
    """What is shown at any second is that second's sky, within the tolerance and rounding."""
    for second in range(1, 31):
        play(module, link, second)
        own = FakeLink("sun", "sky")
        want(own, *SKY, size=16)
        fresh = DynamicSkyLight(own, DynamicSkyLightSettings())
        own.memory[SunMoved] = link.last(SunMoved)
        tell(fresh, own, link.last(SunMoved))
        exact = shown(own)
        allowed = (RADIANCE_TOLERANCE + 2**-10) * np.maximum(exact, 1e-2 * exact.max())
        assert np.all(np.abs(shown(link) - exact) <= allowed)
    assert module.ledger.done["BackgroundChanged"] < 16


def test_small_moves_do_not_add_up(module, link):
    """Each is counted from the sky that is shown, not from the last that was skipped."""
    first = link.last(SunMoved)
    for second in range(1, 600):
        play(module, link, second)
        shown_sun = np.array(link.last(KeyLightChanged).direction)
        now = np.array(link.last(SunMoved).direction)
        assert np.linalg.norm(now - shown_sun) <= sun_step_rad(first.apparent_elevation_rad)


def test_a_sun_on_the_horizon_is_followed_closely(module, link):
    """While its visible share changes, so does the light: no move of the disc is skipped."""
    low = msgspec.structs.replace(
        link.last(SunMoved),
        direction=(0.0, 0.0, 1.0),
        apparent_elevation_rad=0.0,
        visible_disc_fraction=0.5,
    )
    tell(module, link, low)
    count = module.ledger.done["KeyLightChanged"]
    tell(module, link, msgspec.structs.replace(low, visible_disc_fraction=0.4999))
    assert module.ledger.done["KeyLightChanged"] == count + 1


def test_another_turbidity_is_never_within_the_tolerance(module, link):
    """Only the sun's moves are: a setting that somebody changed shows."""
    module.settings = msgspec.structs.replace(module.settings, turbidity=3.0001)
    module.settings_changed("turbidity")
    assert module.ledger.done["BackgroundChanged"] == 2


def test_a_new_albedo_does_not_move_the_sun(module, link):
    """Only what changed is computed: the sun's position is the clock's and the place's."""
    module.settings = msgspec.structs.replace(module.settings, albedo=0.5)
    module.settings_changed("albedo")
    assert module.ledger.done["SunMoved"] == 1

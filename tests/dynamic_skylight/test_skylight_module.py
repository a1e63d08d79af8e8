"""DynamicSkyLight on a kernel: the sun that it moves, and the sky's parts that belong together.

What it shares with every sky, tests/test_sky_contract.py holds.
"""

import numpy as np
import pytest
from dynamic_skylight import sun_position
from noon_in_prague import NOON, PRAGUE, clock, sky_with_its_sun

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.kernel.messages import ChooseSlot
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved

LIGHT = (BackgroundChanged, KeyLightChanged, AmbientChanged)


@pytest.fixture
def sky():
    sky = sky_with_its_sun()
    yield sky
    assert sky.faults == []


def test_clock_and_place_move_the_sun(sky):
    """SunMoved must be the sun of sun_position, as soon as both are known and not before."""
    sky.tell(clock())
    assert sky.taken() == []
    sky.tell(PRAGUE)
    (moved,) = sky.taken()
    sun = sun_position(NOON, 50.0755, 14.4378, altitude_m=235.0)
    east, north, up = sun.direction
    assert moved.direction == pytest.approx((east, up, -north))
    assert moved.elevation_rad == sun.elevation_rad
    assert moved.apparent_elevation_rad == sun.apparent_elevation_rad
    assert moved.azimuth_rad == sun.azimuth_rad
    assert moved.visible_disc_fraction == 1.0


def test_the_north_offset_turns_the_world(sky):
    """With -Z pointing 90 deg clockwise of north, east is ahead: the southern sun stands at +X."""
    turned = SetPlace(latitude_deg=50.0755, longitude_deg=14.4378, north_offset_rad=np.pi / 2)
    sky.tell(clock(), turned)
    (moved,) = sky.taken()
    assert moved.direction[0] > 0.4
    assert abs(moved.direction[2]) < 0.1


def test_without_the_slot_the_sun_stays_where_it_is(sky):
    """A module without the slot skips its work, and catches up when it comes to hold it."""
    sky.tell(ChooseSlot(slot="sun", module="sun_and_eye"), clock(), PRAGUE)
    assert sky.taken() == []
    sky.tell(ChooseSlot(slot="sun", module="dynamic_skylight"))
    assert sky.kinds_taken() == [SunMoved]


def test_the_sun_method_is_a_setting(sky):
    """Preetham's sun stands a little off the ephemeris's, and asking for it moves the sun."""
    sky.tell(clock(), PRAGUE)
    before = sky.last(SunMoved)
    sky.set("sun_method", "preetham")
    apart = np.linalg.norm(np.subtract(sky.last(SunMoved).direction, before.direction))
    assert 0.0 < np.degrees(apart) < 1.2


def test_a_setting_of_the_sky_does_not_move_the_sun(sky):
    """A new albedo makes new light; the sun's position is the clock's and the place's."""
    sky.want(*LIGHT, size=8)
    sky.tell(clock(), PRAGUE)
    sky.taken()
    sky.set("albedo", 0.4)
    assert sky.kinds_taken() == list(LIGHT)


def test_background_light_and_ambient_belong_together(sky):
    """One hour, one scale: float16 cube, aureole towards the sun, harmonics (25, 3) float32."""
    sky.set("turbidity", 6.0)
    sky.want(*LIGHT, size=64)
    sky.tell(clock(), PRAGUE)
    _, background, light, ambient = sky.taken()
    assert background.cube.dtype == np.float16
    assert np.log2(background.radiance_scale) % 1 == 0
    cube = decode_float16(background.cube.values, background.radiance_scale)
    brightest = np.unravel_index(np.argmax(cube[..., 2]), cube.shape[:3])
    assert texel_directions(64)[brightest] @ light.direction > np.cos(0.05)
    assert light.direction == sky.last(SunMoved).direction
    assert all(value > 10.0 for value in light.irradiance_rgb)
    assert ambient.irradiance_sh_rgb.shape == (25, 3)
    assert ambient.irradiance_sh_rgb.dtype == np.float32


def test_a_day_passes_without_fault(sky):
    """Each of 24 hours moves the sun and lights the sky, once."""
    sky.want(*LIGHT, size=8)
    sky.tell(PRAGUE)
    for hour in range(24):
        sky.tell(clock(3600.0 * hour))
        assert sky.kinds_taken() == [SunMoved, *LIGHT]

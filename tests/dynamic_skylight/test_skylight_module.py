"""DynamicSkyLight on a bus: who holds what, who wants what, and what is left undone."""

from datetime import timedelta

import numpy as np
import pytest
from dynamic_skylight import sun_position
from dynamic_skylight.module import DynamicSkyLight
from dynamic_skylight.settings import DynamicSkyLightSettings
from sky_link import NOON, PRAGUE, SKY, FakeLink, tell, want

from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged, SunMoved
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, SetClock, SetSetting, SlotChanged
from vrut_lite.kernel.settings import change


@pytest.fixture
def link():
    """Holds both slots; the sun of a summer noon in Prague has moved."""
    return FakeLink("sun", "sky")


@pytest.fixture
def module(link):
    """A module with its default settings."""
    return DynamicSkyLight(link, DynamicSkyLightSettings())


def test_clock_and_place_move_the_sun(module, link):
    """SunMoved must be the sun of sun_position, as soon as both are known and not before."""
    tell(module, link, NOON)
    assert link.posted == []
    tell(module, link, PRAGUE)
    (moved,) = link.posted
    sun = sun_position(NOON.instant, 50.0755, 14.4378, altitude_m=235.0)
    east, north, up = sun.direction
    assert moved.direction == pytest.approx((east, up, -north))
    assert moved.elevation_rad == sun.elevation_rad
    assert moved.apparent_elevation_rad == sun.apparent_elevation_rad
    assert moved.azimuth_rad == sun.azimuth_rad
    assert moved.visible_disc_fraction == 1.0


def test_the_north_offset_turns_the_world(module, link):
    """With -Z pointing 90 deg clockwise of north, east is ahead: the southern sun stands at +X."""
    tell(module, link, NOON)
    turned = SetPlace(latitude_deg=50.0755, longitude_deg=14.4378, north_offset_rad=np.pi / 2)
    tell(module, link, turned)
    assert link.posted[0].direction[0] > 0.4
    assert abs(link.posted[0].direction[2]) < 0.1


def test_without_the_slot_the_sun_stays_where_it_is(module, link):
    """Who does not hold the slot skips its work, and catches up when it comes to hold it."""
    link.held.remove("sun")
    tell(module, link, NOON)
    tell(module, link, PRAGUE)
    assert link.posted == []
    link.held.add("sun")
    tell(module, link, SlotChanged(name="sun", holder="dynamic_skylight"))
    assert [type(message) for message in link.posted] == [SunMoved]


def set_sun(module, link):
    """Noon in Prague; what is posted of the sun is forgotten."""
    tell(module, link, NOON)
    tell(module, link, PRAGUE)
    link.posted.clear()


def test_an_unwanted_sky_is_not_made(module, link):
    """Nothing at all where no one listens, and it is counted."""
    set_sun(module, link)
    tell(module, link, link.last(SunMoved))
    assert link.posted == []
    for kind in SKY:
        assert module.ledger.skipped[f"{kind.__name__} unwanted"] == 1
        assert module.ledger.done[kind.__name__] == 0


def test_each_message_is_made_only_if_it_is_wanted(module, link):
    """A consumer of light alone must not cost a picture."""
    set_sun(module, link)
    want(link, KeyLightChanged)
    tell(module, link, link.last(SunMoved))
    assert [type(message) for message in link.posted] == [KeyLightChanged]


def test_the_same_sky_is_not_made_twice(module, link):
    """Unchanged inputs: the consumers have it already; a change of one input makes it anew."""
    set_sun(module, link)
    want(link, *SKY, size=16)
    tell(module, link, link.last(SunMoved))
    tell(module, link, link.last(SunMoved))
    assert [type(message) for message in link.posted] == list(SKY)
    assert module.ledger.skipped["BackgroundChanged unchanged"] == 1
    module.settings = change(module.settings, "dynamic_skylight", "turbidity", 5.0)
    module.settings_changed("turbidity")
    assert len(link.posted) == 6
    assert module.ledger.done["BackgroundChanged"] == 2


def test_the_sky_is_said_again_when_the_slot_comes_back(module, link):
    """Another holder's sky was shown in between: the unchanged one must be posted again."""
    set_sun(module, link)
    want(link, *SKY, size=16)
    tell(module, link, link.last(SunMoved))
    link.held.remove("sky")
    tell(module, link, SlotChanged(name="sky", holder="another"))
    assert len(link.posted) == 3
    link.held.add("sky")
    tell(module, link, SlotChanged(name="sky", holder="dynamic_skylight"))
    assert len(link.posted) == 6


def test_the_size_is_the_demands(module, link):
    """Nobody computes 256 for a thumbnail; who names no size gets 256."""
    set_sun(module, link)
    want(link, BackgroundChanged, size=24)
    tell(module, link, link.demands[BackgroundChanged])
    assert link.posted[-1].cube.shape == (6, 24, 24, 3)
    want(link, BackgroundChanged)
    tell(module, link, link.demands[BackgroundChanged])
    assert link.posted[-1].cube.shape == (6, 256, 256, 3)


def test_background_light_and_ambient_belong_together(module, link):
    """One hour, one scale: float16 cube, aureole towards the sun, harmonics (25, 3) float32."""
    module.settings = change(module.settings, "dynamic_skylight", "turbidity", 6.0)
    set_sun(module, link)
    want(link, *SKY, size=64)
    tell(module, link, link.last(SunMoved))
    background, light, ambient = link.posted
    assert background.cube.dtype == np.float16
    assert np.log2(background.radiance_scale) % 1 == 0
    cube = decode_float16(background.cube.values, background.radiance_scale)
    brightest = np.unravel_index(np.argmax(cube[..., 2]), cube.shape[:3])
    assert texel_directions(64)[brightest] @ light.direction > np.cos(0.05)
    assert light.direction == link.last(SunMoved).direction
    assert all(value > 10.0 for value in light.irradiance_rgb)
    assert ambient.irradiance_sh_rgb.shape == (25, 3)
    assert ambient.irradiance_sh_rgb.dtype == np.float32


def test_the_sun_method_is_a_setting(module, link):
    """Preetham's sun stands a little off the ephemeris's, and asking for it moves the sun."""
    set_sun(module, link)
    before = link.last(SunMoved)
    module.settings = change(module.settings, "dynamic_skylight", "sun_method", "preetham")
    module.settings_changed("sun_method")
    apart = np.linalg.norm(np.subtract(link.last(SunMoved).direction, before.direction))
    assert 0.0 < np.degrees(apart) < 1.2


def test_on_the_real_kernel_a_day_passes_without_fault():
    """Injected clock and place must become sky, light and ambient through all 24 hours."""
    kernel = Kernel()
    heard = []
    kernel.tap(lambda message, sender: heard.append(type(message).__name__))
    kernel.add_module(DynamicSkyLight)
    for kind in SKY:
        kernel.inject(Demand(consumer="test", message=kind.__name__, size=16))
    kernel.inject(PRAGUE)
    kernel.pump()
    for hour in range(24):
        kernel.inject(SetClock(instant=NOON.instant + timedelta(hours=hour)))
        kernel.pump()
    assert "Fault" not in heard
    for name in ("SunMoved", *(kind.__name__ for kind in SKY)):
        assert heard.count(name) == 24
    kernel.inject(SetSetting(module="dynamic_skylight", name="albedo", value=0.4))
    kernel.pump()
    assert heard.count("SunMoved") == 24
    assert heard.count("BackgroundChanged") == 25

import numpy as np
import pytest
from session import JOURNAL, MODULES
from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.geometry.cube_map import texel_directions, texel_solid_angles
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.testing.sky_contract import SkyContract, cube_of
from vrut_lite.testing.sky_on_bus import SkyOnBus

from new_sky.module import NewSky
from new_sky.overcast import illuminance_lx, radiance


class TestNewSkyContract(SkyContract):
    """The tests that every sky must pass."""

    module_type = NewSky


def test_the_recorded_session_replays(replay_journal):
    """A difference is a changed sky: accept it with --update-journals."""
    assert replay_journal(JOURNAL, MODULES).messages > 10


@pytest.mark.parametrize("elevation_deg", [90.0, 30.0, 0.0, -6.0])
def test_level_ground_has_the_illuminance_of_the_formula(elevation_deg):
    """The distribution's integral over the hemisphere, texel by texel."""
    lux = illuminance_lx(np.radians(elevation_deg))
    sine = texel_directions(64)[..., 1]
    falls = np.sum(np.maximum(sine, 0.0) * texel_solid_angles(64) * radiance(lux, sine)[..., 1])
    assert falls * LUMENS_PER_WATT == pytest.approx(lux, rel=1e-3)


def test_the_zenith_is_three_times_as_bright_as_the_horizon():
    above, level = radiance(10_000.0, np.array([1.0, 0.0]))
    assert above == pytest.approx(3.0 * level)


def test_the_setting_doubles_the_light_and_no_sun_comes_through():
    sky = SkyOnBus(NewSky)
    sky.want(BackgroundChanged, KeyLightChanged, size=16)
    sky.sun(30.0)
    before = cube_of(sky)
    sky.set("cloud_light", 2.0)
    assert cube_of(sky) == pytest.approx(2.0 * before, rel=2e-3)
    assert sky.last(KeyLightChanged).irradiance_rgb == (0.0, 0.0, 0.0)
    sky.kernel.close()

"""DynamicSkyLight's air: two exponential layers, lit as its own sky is."""

import numpy as np
import pytest
from directions import towards
from dynamic_skylight.air import (
    GROUND_RADIUS_M,
    air_is_seen,
    air_volume,
    layers_of,
)
from dynamic_skylight.daylight import Daylight
from dynamic_skylight.module import DynamicSkyLight

from vrut_lite.geometry.colour import (
    SKYLIGHT_NM,
    rgb_from_spectrum,
    solar_irradiance,
)
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.haze import DEFAULT_HAZE, SetHaze
from vrut_lite.sky.air_volume import look_up_air
from vrut_lite.testing.sky_on_bus import SkyOnBus

AIR = layers_of(DEFAULT_HAZE)


def daylight(elevation_deg, turbidity=3.0):
    """An hour's light with the sun in the north."""
    return Daylight(
        turbidity=turbidity,
        albedo=0.1,
        sun_colour="disc",
        apparent_elevation_rad=float(np.radians(elevation_deg)),
        sun_azimuth_rad=0.0,
        visible_disc_fraction=1.0 if elevation_deg > 0.0 else 0.0,
    )


def volume_at(elevation_deg, altitude_m=2.0, reach_m=1e7, turbidity=3.0):
    """The air under such a sun."""
    sun = tuple(towards(elevation_deg).tolist())
    return air_volume(daylight(elevation_deg, turbidity), sun, altitude_m, reach_m)


def sky_radiance(hour, views, elevation_deg):
    """The model's own sky (n, 3)."""
    gamma = np.arccos(np.clip(views @ towards(elevation_deg), -1.0, 1.0))
    return hour.sky.radiance(np.arccos(np.clip(views[:, 1], 0.0, 1.0)), gamma)


@pytest.mark.parametrize("elevation_deg", [60.0, 20.0, 3.0, -1.0, -6.0, -17.0])
def test_endless_air_is_the_sky(elevation_deg):
    """Without end the air must look as the sky does in its direction, day and twilight: hills
    fade into the very sky. Within 1.5 %, straight lines between rows and columns included; nearer
    to the horizon, where a sky a little higher stands in for it, 8 %."""
    heights, azimuths = (0.6, 2.0, 8.0, 20.0), (40.0, 75.0, 130.0, 180.0)
    views = np.array([towards(h, a) for h in heights for a in azimuths])
    light = look_up_air(volume_at(elevation_deg), views, np.full(len(views), 1e9))
    sky = sky_radiance(daylight(elevation_deg), views, elevation_deg)
    error = np.abs(light.shaded + light.sunlit - sky) / sky.max(axis=-1, keepdims=True)
    near = views[:, 1] < np.sin(np.radians(3.0))
    assert error[~near].max() < 1.5e-2
    assert error[near].max() < 8e-2


def test_no_line_at_the_level_of_the_eye():
    """The model's slope is infinite on the horizon; a hill side that spans it must not show that:
    from 1 deg below to 1 deg above no tenth of a degree changes it by 2 % (14 % if left alone)."""
    heights = np.arange(-1.0, 1.01, 0.1)
    views = np.array([towards(h, 90.0) for h in heights])
    light = look_up_air(volume_at(42.0), views, np.full(len(views), 8e3))
    seen = light.shaded + light.sunlit
    assert np.abs(np.diff(seen, axis=0) / seen[:-1]).max() < 2e-2


@pytest.mark.parametrize("altitude_m", [2.0, 1500.0])
def test_below_the_horizon_it_fades_into_the_sky_on_it(altitude_m):
    """Where nothing passes, what lies below the level must look as the sky a twentieth of a
    degree above it does."""
    views = np.array([towards(-2.0, a) for a in (0.0, 60.0, 180.0)])
    volume = volume_at(20.0, altitude_m, turbidity=10.0)
    light = look_up_air(volume, views, np.full(3, 1e7))
    level = np.array([towards(0.058, a) for a in (0.0, 60.0, 180.0)])
    sky = sky_radiance(daylight(20.0, 10.0), level, 20.0)
    lost = 1.0 - light.transmittance
    assert light.shaded + light.sunlit == pytest.approx(sky * lost, rel=2e-2)


@pytest.mark.parametrize(("height_deg", "altitude_m"), [(0.5, 2.0), (10.0, 2.0), (-3.0, 2000.0)])
def test_transmittance_is_that_of_two_exponentials(height_deg, altitude_m):
    """Held against a plain sum over 20,000 steps along the ray, by wavelength and then turned
    into colour: within 0.003, half of it the channels' own error."""
    view, metres = towards(height_deg, 50.0), np.array([1e3, 1e4, 3e4])
    light = look_up_air(volume_at(30.0, altitude_m, 1e5), np.broadcast_to(view, (3, 3)), metres)
    sun = solar_irradiance(SKYLIGHT_NM)
    for k, end in enumerate(metres):
        s = (np.arange(20_000) + 0.5) * end / 20_000
        up, level = GROUND_RADIUS_M + altitude_m + s * view[1], s * np.hypot(view[0], view[2])
        altitude = np.maximum(np.hypot(up, level) - GROUND_RADIUS_M, 0.0)
        path = np.exp(-altitude[:, None] / AIR.scale_height_m).sum(axis=0) * end / 20_000
        spectral = np.exp(-path @ AIR.extinction)
        expected = rgb_from_spectrum(sun * spectral, SKYLIGHT_NM) / rgb_from_spectrum(
            sun, SKYLIGHT_NM
        )
        assert light.transmittance[k] == pytest.approx(expected, abs=3e-3)


@pytest.mark.parametrize("aerosol", ["continental-average", "desert", "one-lobe"])
def test_the_air_is_that_of_the_haze(aerosol):
    """Its depth at 550 nm is the haze's, and none without haze; dust scatters farther forward."""
    air = layers_of(SetHaze(optical_depth_550=0.2, aerosol=aerosol))
    depth = air.scale_height_m[1:] @ air.extinction[1:]
    at_550 = np.interp(550.0, SKYLIGHT_NM[::-1], depth[::-1])
    assert at_550 == pytest.approx(0.20, abs=0.005)
    forward = air.phase(1.0)[1]
    assert (forward > 10.0) == (aerosol == "desert")
    assert not layers_of(SetHaze(optical_depth_550=0.0, aerosol=aerosol)).extinction[1:].any()


@pytest.mark.parametrize("elevation_deg", [50.0, 5.0, -4.0])
def test_shadows_take_away_what_the_sun_adds(elevation_deg):
    """A shadow takes away part of the light by day, never all of it; with the sun down none."""
    views = np.array([towards(1.0, a) for a in (0.0, 90.0, 180.0)])
    light = look_up_air(volume_at(elevation_deg), views, np.full(3, 1e4))
    share = light.sunlit / (light.sunlit + light.shaded)
    if elevation_deg < 0.0:
        assert np.all(share == 0.0)
    else:
        assert np.all((share[:, 1] > 0.02) & (share[:, 1] < 0.91))


@pytest.mark.parametrize("altitude_m", [0.0, 20_000.0, 59_000.0, 1e6, 4e8])
@pytest.mark.parametrize("elevation_deg", [30.0, -10.0])
def test_numbers_are_sound_at_any_height(altitude_m, elevation_deg):
    """From ground to space no value is negative, infinite or no number."""
    volume = volume_at(elevation_deg, altitude_m, 1e6)
    for part in (volume.light, volume.extinction):
        assert np.isfinite(part.values).all()
        assert part.values.min() >= 0.0


def test_what_air_is_seen():
    """A metre hides nothing, a kilometre of the ground's air does, one high up does not."""
    assert not air_is_seen(DEFAULT_HAZE, 2.0, 1.0)
    assert air_is_seen(DEFAULT_HAZE, 2.0, 1000.0)
    assert not air_is_seen(DEFAULT_HAZE, 50_000.0, 1000.0)
    assert not air_is_seen(DEFAULT_HAZE, 1e6, -1.0)


@pytest.fixture
def sky():
    """The module under a high sun, for someone who wants air."""
    sky = SkyOnBus(DynamicSkyLight)
    sky.want(AirChanged)
    sky.sun(60.0)
    return sky


def test_air_is_posted_when_something_stands_in_it(sky):
    """Nothing without things in the air; then one volume past them, and no second for the same,
    for an eye that moved unseen, or for things a little nearer."""
    assert sky.taken() == []
    assert sky.counters.skipped["AirChanged without things in it"] == 1
    sky.eye(0.0, 20_000.0)
    (message,) = sky.taken()
    assert message.volume.reach_m >= 20_000.0
    assert message.source == "dynamic_skylight"
    for height_m, reach_m in ((0.0, 20_000.0), (3.0, 20_000.0), (0.0, 19_500.0)):
        sky.eye(height_m, reach_m)
    assert sky.taken() == []
    sky.eye(800.0, 20_000.0)
    sky.eye(800.0, 90_000.0)
    assert [m.volume.observer_altitude_m for m in sky.taken()] == [800.0, 800.0]


def test_air_too_thin_to_be_seen_is_none(sky):
    """Around a thing on a table there is none; posted once, and again after another sky."""
    sky.eye(0.0, 1.0)
    sky.eye(0.0, 0.9)
    assert [m.volume for m in sky.taken()] == [None]
    sky.lose_slot()
    sky.regain_slot()
    assert [m.volume for m in sky.taken()] == [None]

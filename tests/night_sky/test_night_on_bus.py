"""The night through a kernel: one key light, a sum of sources, and no jump between them."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from dynamic_skylight.module import DynamicSkyLight
from dynamic_skylight.twilight import NIGHT_ILLUMINANCE_LX
from dynamic_skylight.twilight_curve import illuminance_lx
from night_sky.module import NightSky

from vrut_lite.array import Array
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, EnableModule, Fault, SetClock, SetSetting
from vrut_lite.messages.moon_path import MoonPathChanged
from vrut_lite.messages.night import MoonDiscChanged, NightLightChanged, StarsChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.sky.night_glow import glow_cube, map_directions
from vrut_lite.sky.sky_at_night import SkyAtNight
from vrut_lite.sky.sky_of_hour import Background, Sky, SunDisc

FULL_MOON = datetime(2026, 1, 3, 23, tzinfo=UTC)
MOONLESS = datetime(2026, 10, 10, 22, tzinfo=UTC)
LIGHT = (BackgroundChanged, KeyLightChanged, AmbientChanged)
UP = (0.0, 1.0, 0.0)


class Night:
    """A kernel in Prague with a sky, a sun and the night."""

    def __init__(self):
        self.kernel, self.faults = Kernel(), []
        self.kernel.tap(lambda m, _: self.faults.append(m.error) if type(m) is Fault else None)
        self.kernel.add_module(DynamicSkyLight)
        self.kernel.add_module(NightSky)
        self.tell(SetPlace(latitude_deg=50.08, longitude_deg=14.44))

    def tell(self, *messages):
        for message in messages:
            self.kernel.inject(message)
        self.kernel.pump_until_idle()
        assert not self.faults

    def want(self):
        self.tell(*(Demand(consumer="test", message=k.__name__, size=32) for k in LIGHT))

    def want_points(self):
        kinds = StarsChanged, MoonDiscChanged
        self.tell(*(Demand(consumer="test", message=k.__name__) for k in kinds))

    def at(self, instant):
        self.tell(SetClock(instant=instant))
        return self

    def lux(self):
        """Of level ground, by the key light and by the sky."""
        key, ambient = self.kernel.last(KeyLightChanged), self.kernel.last(AmbientChanged)
        direct = float(luminance(key.irradiance_rgb)) * max(key.direction[1], 0.0)
        sky = float(luminance(evaluate_irradiance(ambient.irradiance_sh_rgb.values, UP)))
        return direct * LUMENS_PER_WATT, sky * LUMENS_PER_WATT

    @property
    def counters(self):
        return self.kernel.seats["night_sky"].module.counters


@pytest.fixture(scope="module")
def kept():
    night = Night()
    yield night
    night.kernel.close()


@pytest.fixture
def night(kept):
    """The same kernel for all, that most of them start with night switched on."""
    kept.tell(SetSetting(module="night_sky", name="night", value=True))
    return kept


@pytest.fixture
def unused():
    night = Night()
    yield night
    night.kernel.close()


def test_lamps_of_the_lands_are_told_by_night(kept):
    """Lands under a brighter zenith shine more, in a lamp's colour; by day and far from towns none.

    The air over them is then as bright as the zenith that was asked for.
    """
    kept.want()
    kept.at(MOONLESS)
    assert kept.kernel.last(AmbientChanged).lamps_rgb == (0.0, 0.0, 0.0)
    told = []
    for magnitude in (20.0, 18.0):
        setting = SetSetting(module="night_sky", name="zenith_magnitude", value=magnitude)
        kept.tell(setting)
        told.append(kept.kernel.last(AmbientChanged).lamps_rgb)
    (red, green, blue), dimmer = told[1], told[0]
    assert red > green > blue > 0.0
    extra = [10.0 ** (-0.4 * m) - 10.0 ** (-0.4 * 22.0) for m in (18.0, 20.0)]
    assert red / dimmer[0] == pytest.approx(extra[0] / extra[1], rel=1e-6)
    kept.at(MOONLESS.replace(hour=11))
    assert kept.kernel.last(AmbientChanged).lamps_rgb == (0.0, 0.0, 0.0)
    kept.tell(SetSetting(module="night_sky", name="zenith_magnitude", value=22.0))


def test_by_full_moon_the_moon_is_the_key_light(night):
    night.want()
    by_moon, by_sky = night.at(FULL_MOON).lux()
    key = night.kernel.last(KeyLightChanged)
    assert key.body == "moon"
    assert key.direction == night.kernel.last(NightLightChanged).moon.place.direction
    # A wolf moon, 66 deg high; Kyba et al. 2017 have 0.32 lx at most.
    assert 0.15 < by_moon + by_sky < 0.32
    assert 0.02 < by_sky < 0.08


def test_a_moonless_night_has_starlight_alone(night):
    night.want()
    by_moon, by_sky = night.at(MOONLESS).lux()
    assert by_moon == 0.0
    # US Naval Observatory 0.5 mlx, RCA handbook 1 mlx.
    assert 0.5e-3 < by_sky < 1.6e-3


def test_the_sun_keeps_the_key_light_while_any_of_it_is_up(night):
    night.want()
    bodies = []
    for minute in range(0, 60, 6):
        night.at(datetime(2026, 1, 3, 15, 0, tzinfo=UTC) + timedelta(minutes=minute))
        up = night.kernel.last(SunMoved).visible_disc_fraction > 0.0
        bodies.append(night.kernel.last(KeyLightChanged).body)
        moon = night.kernel.last(NightLightChanged).moon.place
        risen = moon.visible_disc_fraction > 0.0
        assert bodies[-1] == ("moon" if risen and not up else "sun")
    assert set(bodies) == {"sun", "moon"}


def test_the_light_has_no_step_at_dusk(night):
    """Sunset, moonrise and the join of the models: the fall of a minute differs little from the
    last one's.
    """
    night.want()
    start = datetime(2026, 1, 3, 15, 0, tzinfo=UTC)
    fall = np.diff(
        np.log([sum(night.at(start + timedelta(minutes=3 * m)).lux()) for m in range(25)])
    )
    assert (fall < 0.0).all()
    assert np.abs(np.diff(fall)).max() < 0.15


def test_the_suns_part_of_late_twilight_is_the_published_curve(night):
    night.want()
    start = datetime(2026, 10, 10, 16, 0, tzinfo=UTC)
    for minute in range(0, 75, 5):
        _, lux = night.at(start + timedelta(minutes=minute)).lux()
        degrees = np.degrees(night.kernel.last(SunMoved).elevation_rad)
        if not -17.5 < degrees < -7.1:
            continue
        night.tell(EnableModule(module="night_sky", enabled=False))
        _, alone = night.lux()
        night.tell(EnableModule(module="night_sky", enabled=True))
        curve = float(illuminance_lx(degrees) - illuminance_lx(-18.0))
        assert alone - NIGHT_ILLUMINANCE_LX == pytest.approx(curve, rel=0.01, abs=2e-6)
        glow = night.kernel.last(NightLightChanged).glow_rgb.values
        of_night = luminance(irradiance_of_map(glow)) * LUMENS_PER_WATT
        assert lux == pytest.approx(curve + of_night, rel=0.02)


def irradiance_of_map(glow):
    directions = map_directions(*glow.shape[:2])
    step = (0.5 * np.pi / glow.shape[0]) * (2.0 * np.pi / glow.shape[1])
    up = directions[..., 1]
    return (glow * (up * np.sqrt(1.0 - up * up) * step)[..., None]).sum(axis=(0, 1))


def test_off_nothing_is_computed_and_the_grey_night_stays(unused):
    night = unused
    night.tell(SetSetting(module="night_sky", name="night", value=False))
    night.want()
    by_sun, by_sky = night.at(MOONLESS).lux()
    assert by_sun == 0.0
    assert by_sky == pytest.approx(NIGHT_ILLUMINANCE_LX, rel=0.02)
    assert not night.counters.done
    assert night.kernel.last(NightLightChanged) is None


def test_without_demand_nothing_is_computed(unused):
    night = unused
    night.at(FULL_MOON)
    assert not night.counters.done


def test_switched_off_the_night_goes(night):
    night.want()
    night.at(FULL_MOON).tell(SetSetting(module="night_sky", name="night", value=False))
    assert night.kernel.last(KeyLightChanged).body == "sun"
    assert sum(night.lux()) == pytest.approx(NIGHT_ILLUMINANCE_LX, rel=0.02)


def test_disc_and_stars_stand_above_the_horizon(night):
    night.want()
    night.want_points()
    night.at(FULL_MOON)
    disc, stars = night.kernel.last(MoonDiscChanged), night.kernel.last(StarsChanged)
    assert disc.direction == night.kernel.last(NightLightChanged).moon.place.direction
    assert len(stars.direction.values) > 10_000
    assert stars.direction.values[:, 1].min() > 0.0
    # Jupiter, then Sirius.
    brightest = luminance(stars.irradiance_rgb.values[:2]) * LUMENS_PER_WATT
    assert 2e-6 < brightest[1] < brightest[0] < 4e-5


def test_an_eclipse_dims_sun_and_sky(night):
    """Half an hour before totality and outside it: as the share of the sun that is left."""
    night.want()
    night.tell(SetPlace(latitude_deg=42.34, longitude_deg=-3.70))
    eclipse = datetime(2026, 8, 12, 18, 14, tzinfo=UTC)
    dimmed = night.at(eclipse).lux()
    left = np.array(night.kernel.last(NightLightChanged).sun_left_rgb)
    night.tell(SetSetting(module="night_sky", name="night", value=False))
    whole = night.lux()
    night.tell(SetPlace(latitude_deg=50.08, longitude_deg=14.44))
    assert 0.2 < left[1] < 0.35
    np.testing.assert_allclose(np.array(dimmed) / whole, left[1], rtol=0.03)


class EvenSky(Sky):
    """As bright everywhere."""

    def __init__(self, radiance):
        self.radiance = radiance

    def background(self, size):
        return Background(np.full((6, size, size, 3), self.radiance, np.float32), np.zeros(3))

    def sun(self):
        return SunDisc(np.full(3, self.radiance))

    def ambient(self):
        return np.full((25, 3), self.radiance)


def test_light_of_sun_moon_and_glow_is_their_sum(night):
    """Scattering is linear: to rounding nothing is lost or counted twice."""
    night.want()
    moon = night.at(FULL_MOON).kernel.last(NightLightChanged).moon
    glow = Array(np.full((4, 8, 3), 0.25, np.float32))
    whole = SkyAtNight(EvenSky(1.0), EvenSky(2e5), moon, glow, 1.0, "moon")
    share = np.array(moon.of_sunlight_rgb)
    above = texel_directions(8)[..., 1] > 0.0
    seen = whole.background(8).cube[above]
    assert np.allclose(seen, 1.25 + 2e5 * share, rtol=1e-6)
    assert np.allclose(whole.sun().irradiance_rgb, 2e5 * share, rtol=1e-6)
    by_glow = SkyAtNight(EvenSky(0.0), None, None, glow, 1.0, "sun").ambient()
    assert np.allclose(whole.ambient(), 1.0 + 2e5 * share + by_glow, rtol=1e-6)


def test_the_map_of_the_glow_keeps_its_light_as_a_cube():
    rng = np.random.default_rng(3)
    glow = rng.random((45, 90, 3)).astype(np.float32)
    cube = glow_cube(Array(glow), 64, (0.0, 0.0, 0.0))
    directions = map_directions(45, 90)
    node = 20, 70
    texel = np.argmax(texel_directions(64).reshape(-1, 3) @ directions[node])
    assert cube.reshape(-1, 3)[texel] == pytest.approx(glow[node], abs=0.45)
    assert (cube[3] == 0.0).all()
    # The mean over the hemisphere survives.
    even = glow_cube(Array(np.ones((45, 90, 3), np.float32)), 64, (0.0, 0.0, 0.0))
    assert np.allclose(even[texel_directions(64)[..., 1] > 0.0], 1.0, atol=1e-6)


def test_the_moons_path_is_told_to_who_wants_it():
    """At each rise and set of it the moon's own light has its upper limb on the horizon, which is
    another search; without the night there is no path."""
    night = Night()
    night.want()
    night.at(FULL_MOON)
    assert night.kernel.last(MoonPathChanged) is None
    night.tell(Demand(consumer="test", message=MoonPathChanged.__name__))
    path = night.kernel.last(MoonPathChanged)
    assert path.rises_s
    assert path.sets_s
    for instant in path.instants(path.rises_s + path.sets_s):
        moon = night.at(instant).kernel.last(NightLightChanged).moon
        limb = moon.place.apparent_elevation_rad + moon.angular_radius_rad
        assert abs(np.degrees(limb)) < 0.06
    night.tell(SetSetting(module="night_sky", name="night", value=False))
    assert night.kernel.last(MoonPathChanged).direction.shape[0] == 0

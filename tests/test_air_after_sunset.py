"""Air in the light of sun and moon: each lights it from its own place, whichever casts shadows."""

from functools import lru_cache

import numpy as np
import pytest
from bruneton_sky.ground_light import SKYLIGHT_EXPONENT
from bruneton_sky.module import BrunetonSky
from bruneton_sky.solved_sky import SolvedSky
from directions import towards
from dynamic_skylight.module import DynamicSkyLight
from hypothesis import given
from hypothesis import strategies as st
from long_parameters import mostly_long
from moon_on_bus import FULL_MOON, PlaceMoon, SkyUnderMoon, body_at, moved

from vrut_lite.atmosphere.refraction import horizon_elevation
from vrut_lite.geometry.colour import luminance, rgb_from_spectrum
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.messages.tolerance import tolerance_of
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.air_volume import light_of, look_up_air
from vrut_lite.sky.sky_at_night import night_share, sun_share

# Clear air first: its shadow of the Earth is the sharpest.
HAZES = mostly_long([0.05, 0.2, 0.5], (0.05).__eq__)
SUNS = mostly_long(
    [5.0, 2.0, 0.5, 0.2, 0.0, -0.3, -1.0, -2.0, -3.0, -4.0, -6.0, -8.0, -10.0, -12.0, -14.0, -16.0,
     -18.0, -18.5],
    (5.0, -1.0, -4.0, -8.0, -18.0).__contains__,
)  # fmt: skip
MOONS = {
    "none": PlaceMoon(),
    "down": PlaceMoon(elevation_deg=-3.0, azimuth_deg=-135.0),
    "low": PlaceMoon(elevation_deg=2.0, azimuth_deg=-135.0),
    "up": PlaceMoon(elevation_deg=40.0, azimuth_deg=-135.0),
    "eclipsed": PlaceMoon(elevation_deg=40.0, azimuth_deg=-135.0, share=1e-5 * FULL_MOON),
}
# Eight azimuths, among them 18 degrees from the sun's and 3 from the moon's.
SUN_AZIMUTH_DEG, AZIMUTHS_DEG = -60.0, np.arange(3.0, 360.0, 45.0)
HEIGHTS_DEG = (0.3, 1.2, 2.0, 4.0, 8.0, 15.0, 50.0, 80.0)
METRES = np.array([1e2, 1e3, 1e4, 3e4, 1e5])
# Where the key light passes to the moon: an eye at 2 m sees the sun set.
SUNSET_DEG = float(np.degrees(horizon_elevation(2.0)))
# Radiance of a moonless sky, W m^-2 sr^-1.
AIRGLOW = 3e-7
CUBE = 256


@lru_cache
def under_moon(module_type: type, depth_550: float) -> SkyUnderMoon:
    """One kernel for all suns and moons of a haze."""
    return SkyUnderMoon(module_type, depth_550)


def added(volume: AirVolume, views: FloatArray, metres: FloatArray) -> FloatArray:
    """Radiance (views, metres, 3) of the air before things."""
    every = np.repeat(views, metres.size, axis=0)
    light = look_up_air(volume, every, np.tile(metres, len(views)))
    return (light.shaded + light.sunlit).reshape(len(views), metres.size, 3)


@lru_cache
def solved_by(sky: SkyUnderMoon) -> SolvedSky:
    """The accurate look at the atmosphere of a Bruneton sky's own pictures."""
    module = sky.kernel.seats["bruneton_sky"].module
    work = module.prepare(0.0, module.quality(tolerance_of(module.link)))
    return SolvedSky(field=work.function(*work.arguments))


@pytest.mark.parametrize("moon", MOONS.values(), ids=MOONS)
@pytest.mark.parametrize("sun_deg", SUNS)
@pytest.mark.parametrize("depth_550", HAZES)
def test_bruneton_air_is_radiance_to_point(
    depth_550: float, sun_deg: float, moon: PlaceMoon
) -> None:
    """Before things at 0.1 to 100 km the air must be the sum of `radiance_to_point` under the sun
    and, dimmed, under a sun in the moon's place: within 3 % of the brightest channel (the issue's
    figure; 1.8 % is found). Air lit from the key light's place alone errs by up to 1,000 %."""
    sky = under_moon(BrunetonSky, depth_550)
    volume = sky.air(sun_deg, moon, SUN_AZIMUTH_DEG)
    views = np.array([towards(h, a) for a in AZIMUTHS_DEG for h in HEIGHTS_DEG])
    solved = solved_by(sky)
    sun = body_at(sun_deg, SUN_AZIMUTH_DEG)
    wanted = sun_share(sun) * _to_point(solved, sun.direction, views)
    if moon.elevation_deg > -8.0:
        by_moon = _to_point(solved, towards(moon.elevation_deg, moon.azimuth_deg), views)
        wanted = wanted + night_share(sun) * moon.share * by_moon
    error = np.abs(added(volume, views, METRES) - wanted) / wanted.max(axis=-1, keepdims=True)
    assert error.max() < 3e-2


def _to_point(solved: SolvedSky, direction: FloatArray, views: FloatArray) -> FloatArray:
    """Radiance (views, METRES, 3) under a sun in a direction."""
    sun = np.asarray(direction)
    rays = views[:, 1, None], sun[1], np.clip(views @ sun, -1.0, 1.0)[:, None]
    spectral, _ = solved.radiance_to_point(2.0, *rays, METRES)
    return rgb_from_spectrum(spectral, solved.atmosphere.wavelength_nm, SKYLIGHT_EXPONENT)


@lru_cache
def _texels() -> tuple[np.ndarray, FloatArray]:
    """Texels (n,) of the sky's cube near eight azimuths and lowest above 1 degree, where the
    twilight table has a kink, and their directions (n, 3)."""
    every = texel_directions(CUBE).reshape(-1, 3)
    wanted = [towards(h, a) for a in AZIMUTHS_DEG for h in HEIGHTS_DEG[1:]]
    found = [int(np.argmax(every @ one)) for one in wanted]
    low = np.argsort(np.where(every[:, 1] > np.sin(np.radians(1.0)), every[:, 1], 2.0))[:256]
    texels = np.concatenate([found, low])
    return texels, every[texels]


def over_sky(sky: SkyUnderMoon, volume: AirVolume) -> FloatArray:
    """The air of a hundred metres to all there is over the sky behind it (views, metres, 3)."""
    texels, views = _texels()
    assert views[:, 1].min() > np.sin(np.radians(1.0))
    background = sky.last(BackgroundChanged)
    behind = background.cube.values.reshape(-1, 3)[texels].astype(float)
    behind *= background.radiance_scale
    return added(volume, views, np.append(METRES, 1e7)) / np.maximum(behind, 1e-30)[:, None]


@pytest.mark.parametrize("moon", MOONS.values(), ids=MOONS)
@pytest.mark.parametrize("sun_deg", SUNS)
@pytest.mark.parametrize("depth_550", HAZES)
def test_dynamic_air_never_outshines_its_sky(
    depth_550: float, sun_deg: float, moon: PlaceMoon
) -> None:
    """Hills fade into the sky behind them: along rays above 1 degree, to any distance, the air has
    at most 1.03 of the sky's light in any channel (1.02 is found). It was 14 times as bright where
    the moon took the key light over from the sun."""
    sky = under_moon(DynamicSkyLight, depth_550)
    sky.want(BackgroundChanged, size=CUBE)
    volume = sky.air(sun_deg, moved(moon, glow=AIRGLOW), SUN_AZIMUTH_DEG)
    assert over_sky(sky, volume).max() < 1.03


ELEVATIONS = st.one_of(
    st.floats(-19.5, 8.0), st.sampled_from([0.5, SUNSET_DEG, -0.5, -7.0, -8.0, -18.0, -19.0])
)
PLACES = st.builds(
    PlaceMoon,
    elevation_deg=st.one_of(ELEVATIONS, st.floats(8.0, 90.0)),
    azimuth_deg=st.floats(-180.0, 180.0),
    share=st.sampled_from([FULL_MOON, 0.1 * FULL_MOON, 1e-5 * FULL_MOON, 0.0]),
    glow=st.sampled_from([0.0, AIRGLOW, 1e-5]),
    sun_left=st.sampled_from([1.0, 0.5, 1e-3, 0.0]),
)


@given(ELEVATIONS, PLACES, st.sampled_from([0.05, 0.2, 0.5]))
def test_any_sun_and_moon_make_air_that_is_light(
    sun_deg: float, moon: PlaceMoon, depth_550: float
) -> None:
    """Under any sun and moon, in eclipses too, light is finite and not negative, and the air never
    outshines the sky behind it."""
    sky = under_moon(DynamicSkyLight, depth_550)
    sky.want(BackgroundChanged, size=CUBE)
    volume = sky.air(sun_deg, moon, SUN_AZIMUTH_DEG)
    kinds = light_of(volume), *(() if volume.second is None else (volume.second.light.values,))
    assert all(np.isfinite(light).all() and light.min() >= 0.0 for light in kinds)
    assert over_sky(sky, volume).max() < 1.03


@pytest.mark.parametrize("module_type", [DynamicSkyLight, BrunetonSky])
@pytest.mark.parametrize("moon", ["low", "up", "eclipsed"])
@pytest.mark.parametrize("event_deg", [0.5, SUNSET_DEG, -0.5, -18.0, -19.0])
def test_air_has_no_step(event_deg: float, moon: str, module_type: type) -> None:
    """Where the night begins to count, the key light passes from the sun to the moon, or the last
    twilight fades, a thousandth of a degree changes the air by 1 % at most: nothing flashes."""
    sky = under_moon(module_type, 0.2)
    views = np.array([towards(h, a) for a in AZIMUTHS_DEG for h in (1.0, 5.0, 20.0)])
    sky.want(KeyLightChanged)
    seen, keys = [], []
    for aside in (5e-4, -5e-4):
        night = moved(MOONS[moon], glow=AIRGLOW)
        volume = sky.air(event_deg + aside, night, SUN_AZIMUTH_DEG)
        seen.append(luminance(added(volume, views, METRES)))
        keys.append(sky.last(KeyLightChanged).body)
    assert (keys == ["sun", "moon"]) == (event_deg == SUNSET_DEG)
    assert np.abs(seen[1] / seen[0] - 1.0).max() < 1e-2


def test_shadows_are_of_the_key_light_alone() -> None:
    """After sunset under a moon the scene casts the moon's shadows: what a shadow takes from the
    air is moonlight, and twilight stays."""
    sky = under_moon(BrunetonSky, 0.2)
    views, metres = np.array([towards(4.0, -130.0), towards(4.0, 60.0)]), np.full(2, 1e4)
    night = look_up_air(sky.air(-18.5, MOONS["up"]), views, metres)
    dusk = look_up_air(sky.air(-6.0, MOONS["up"]), views, metres)
    sun_alone = look_up_air(sky.air(-6.0, MOONS["none"]), views, metres)
    assert dusk.sunlit == pytest.approx(night.sunlit, rel=1e-3)
    both = dusk.shaded + dusk.sunlit
    assert both == pytest.approx(
        sun_alone.shaded + sun_alone.sunlit + night.shaded + night.sunlit, rel=2e-2
    )


@pytest.mark.parametrize("module_type", [DynamicSkyLight, BrunetonSky])
def test_an_eclipse_dims_a_moon_that_stands_still(module_type: type) -> None:
    """Within minutes the Earth's shadow takes all but a hundred thousandth of the moonlight, while
    the moon moves unseen: air and key light must follow the light."""
    sky = under_moon(module_type, 0.2)
    sky.want(KeyLightChanged)
    views = np.array([towards(4.0, 60.0)])
    bright = added(sky.air(-25.0, MOONS["up"]), views, METRES)
    key = np.array(sky.last(KeyLightChanged).irradiance_rgb)
    dark = added(sky.air(-25.0, MOONS["eclipsed"]), views, METRES)
    assert dark == pytest.approx(1e-5 * bright, rel=5e-3)
    assert np.array(sky.last(KeyLightChanged).irradiance_rgb) == pytest.approx(1e-5 * key, rel=1e-6)

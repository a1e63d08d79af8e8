"""Two skies of one haze: Hosek and Wilkie's brought to it, and the sun behind the same air."""

import numpy as np
import pytest
from bruneton_sky import solve
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of, spectral_atmosphere_of
from bruneton_sky.sun_light import seen_irradiance_rgb
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie.levelled_sky import LevelledSky
from dynamic_skylight.module import DynamicSkyLight
from long_parameters import mostly_long

from vrut_lite.atmosphere.equal_haze import DEPTHS, LEVELS, TURBIDITIES, equal_sky
from vrut_lite.geometry.colour import luminance
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.sky.clear_sun import sun_irradiance_rgb
from vrut_lite.testing.sky_on_bus import SkyOnBus

SETTINGS = BrunetonSkySettings(albedo=0.1)


def continental(depth):
    return SetHaze(optical_depth_550=depth, aerosol="continental-average")


def sky_directions(count=200):
    """Unit vectors evenly over the sky, up along z."""
    k = np.arange(count) + 0.5
    z, turn = k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    level = np.sqrt(1.0 - z * z)
    return np.stack([level * np.cos(turn), level * np.sin(turn), z], axis=-1)


@pytest.mark.parametrize("depth", mostly_long([0.04, 0.12, 0.2], (0.12).__ne__))
def test_both_skies_are_alike_at_equal_haze(depth):
    """Luminance within 0.8 to 1.25 in nine tenths of the sky, also between the table's suns."""
    solved, d = solve(atmosphere_of(SETTINGS, 0.0, continental(depth))), sky_directions()
    for elevation in np.radians([10.0, 15.0, 37.0, 75.0]):
        nu = np.clip(d @ [np.cos(elevation), 0.0, np.sin(elevation)], -1.0, 1.0)
        right = luminance(solved.radiance_rgb(0.0, d[:, 2], np.sin(elevation), nu))
        turbidity, level = equal_sky(depth, elevation)
        model = LevelledSky(turbidity, 0.1, elevation, level)
        ratio = luminance(model.radiance(np.arccos(d[:, 2]), np.arccos(nu))) / right
        assert np.mean((ratio > 0.8) & (ratio < 1.25)) >= 0.9


def test_a_hazier_sky_never_steps():
    """Between the table's points and beyond its ends values change evenly."""
    depths, suns = np.linspace(0.0, 0.7, 701), np.radians(np.linspace(-5.0, 90.0, 96))
    skies = np.array([[equal_sky(depth, sun) for sun in suns[::5]] for depth in depths])
    assert np.abs(np.diff(skies, axis=0)).max(axis=(0, 1)) == pytest.approx([0.07, 0.004], abs=0.01)
    assert tuple(skies[-1, 0]) == (TURBIDITIES[-1], LEVELS[-1][0])
    assert len(DEPTHS) == len(TURBIDITIES) == len(LEVELS)


@pytest.mark.parametrize(
    "haze", [continental(0.1), SetHaze(optical_depth_550=0.2), continental(0.5)]
)
def test_the_sun_behind_the_air_is_the_solved_skys(haze):
    """The closed form of slant paths against the solver's own, from the zenith to a low sun."""
    air = spectral_atmosphere_of(SETTINGS, 0.0, haze)
    for elevation_deg, within in ((90.0, 0.002), (30.0, 0.002), (10.0, 0.004), (3.0, 0.04)):
        elevation = np.radians(elevation_deg)
        solved = seen_irradiance_rgb(air, 0.0, np.sin(elevation))
        ours = sun_irradiance_rgb(haze, elevation)
        assert ours == pytest.approx(solved, rel=within, abs=within * solved.max())


def test_the_published_model_is_a_choice_away():
    """The module's zenith is the model's at Preetham's turbidity, or at the matched one."""
    depth, sun = 0.1, np.radians(40.0)
    turbidity, level = equal_sky(depth, sun)
    asked = {
        "published": HosekWilkieSky(continental(depth).turbidity, 0.1, sun),
        "equal-haze": LevelledSky(turbidity, 0.1, sun, level),
    }
    for name, model in asked.items():
        sky = SkyOnBus(DynamicSkyLight, sky_level=name)
        sky.want(BackgroundChanged)
        sky.tell(continental(depth))
        sky.taken()
        sky.sun(40.0)
        said = next(m for m in sky.taken() if isinstance(m, BackgroundChanged))
        n = said.cube.shape[1] // 2
        zenith = said.cube.values[2, n - 1 : n + 1, n - 1 : n + 1].astype(float).mean(axis=(0, 1))
        expected = model.radiance(0.0, 0.5 * np.pi - sun)
        assert zenith * said.radiance_scale == pytest.approx(expected, rel=0.01)

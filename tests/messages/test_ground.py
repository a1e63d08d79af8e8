"""One ground for every sky: an input that skies follow, unless their settings name an albedo."""

import msgspec
import numpy as np
import pytest
from bruneton_sky.module import BrunetonSky
from command_output import shared_options
from dynamic_skylight.module import DynamicSkyLight
from light_transport.jobs import hour_of
from message_samples import SCENE
from photo_sky.module import PhotoSky
from weather_sky.module import WeatherSky

from vrut_lite.atmosphere.ground_reflectance import GREY, GroundReflectance
from vrut_lite.errors import UserError
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.ground import DEFAULT_GROUND, SetGround, parse_ground
from vrut_lite.messages.sky import (
    AmbientChanged,
    BackgroundChanged,
    LookAlong,
    SkyRadianceChanged,
    SpectrumSeen,
)
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.project import Project, load_project, save_project
from vrut_lite.scene.scene_state import SceneState
from vrut_lite.sky.ground_albedo import ground_albedo
from vrut_lite.testing.sky_on_bus import SkyOnBus

SKIES = {"albedo": [BrunetonSky, DynamicSkyLight, WeatherSky], "photo_albedo": [PhotoSky]}
PAIRS = [(sky, setting) for setting, skies in SKIES.items() for sky in skies]
LIGHT = (BackgroundChanged, KeyLightChanged, AmbientChanged)
NAMES = ("background", "key_light", "ambient")
GRASS = GroundReflectance.named("grass")


def above(kind, *inputs, **settings):
    """A sky under a sun 40 degrees high, after inputs."""
    sky = SkyOnBus(kind, **settings)
    for message in LIGHT:
        sky.want(message)
    sky.sun(40.0)
    for message in inputs:
        sky.tell(message)
    return sky


def albedo_of(sky):
    """Albedo (3,) of the ground that the sky's messages show."""
    return ground_albedo(*(sky.last(kind) for kind in LIGHT))


@pytest.mark.parametrize(("kind", "setting"), PAIRS)
def test_every_sky_has_the_chosen_ground(kind, setting):
    """pi L / E of the messages, by which frame and light transport reflect, is the ground's.

    E is made of 25 harmonics, which miss the edge between sky and ground by up to 3 %.
    """
    sky = above(kind, SetGround(ground="grass"))
    np.testing.assert_allclose(albedo_of(sky), GRASS.rgb, rtol=0.03)
    sky.tell(SetGround(ground="snow", albedo=0.5))
    snow = GroundReflectance.named("snow").with_albedo(0.5)
    np.testing.assert_allclose(albedo_of(sky), snow.rgb, rtol=0.05)
    sky.set(setting, 0.3)
    np.testing.assert_allclose(albedo_of(sky), 0.3, rtol=0.04)
    sky.set(setting, None)
    np.testing.assert_allclose(albedo_of(sky), snow.rgb, rtol=0.05)


@pytest.mark.parametrize("kind", [BrunetonSky, DynamicSkyLight, WeatherSky])
def test_frame_and_light_between_surfaces_reflect_alike(kind):
    """One albedo: the disc's, and that by which light transport returns what falls on the ground.

    What it returns is then the radiance that the sky shows as ground, so that no light is lost.
    """
    sky = above(kind, SetGround(ground="grass"))
    sky.want(SkyRadianceChanged)
    lit = {name: sky.last(kind) for name, kind in zip(NAMES, LIGHT, strict=True)}
    state = SceneState().with_light(**lit)
    hour = hour_of(SkyLightChanged(**lit, radiance=sky.last(SkyRadianceChanged), source="test"))
    np.testing.assert_allclose(hour.ground_albedo_rgb, state.ground_albedo_rgb, rtol=1e-3)
    direct = np.array(hour.key_irradiance_rgb) * hour.key_direction[1]
    falls = evaluate_irradiance(hour.open_sky, np.array([0.0, 1.0, 0.0])) + direct
    returned = np.array(hour.ground_albedo_rgb) * falls / np.pi
    np.testing.assert_allclose(returned, hour.ground_radiance_rgb, rtol=1e-5)


@pytest.mark.parametrize(("kind", "setting"), PAIRS)
def test_the_default_ground_is_grey(kind, setting):
    """A kernel in which nobody chose a ground has the grey of 0.1, as in earlier journals."""
    unset, grey = above(kind), above(kind, DEFAULT_GROUND)
    own = above(kind, SetGround(ground="snow"), **{setting: 0.1})
    cubes = {sky.last(AmbientChanged).irradiance_sh_rgb.digest for sky in (unset, grey, own)}
    assert len(cubes) == 1


@pytest.mark.parametrize("kind", [BrunetonSky, DynamicSkyLight])
def test_skies_reflect_by_wavelength(kind):
    """Above grass the zenith gains at 550 nm, where grass reflects most, and loses in the blue."""
    seen = []
    for ground in (SetGround(ground="grey", albedo=GRASS.albedo), SetGround(ground="grass")):
        sky = above(kind, ground)
        sky.want(SpectrumSeen)
        sky.tell(LookAlong(direction=(0.0, 1.0, 0.0)))
        found = sky.last(SpectrumSeen)
        seen.append(np.interp((450.0, 550.0), found.wavelength_nm, found.radiance))
    blue, green = seen[1] / seen[0]
    assert blue < 0.995
    assert green > 1.001


def test_the_scenes_border_is_the_ground_around_it():
    """Another scene brings another ground; one without a border, and none at all, are grey."""
    sky = above(DynamicSkyLight, SetGround(ground="scene"))
    np.testing.assert_allclose(albedo_of(sky), GREY.rgb, rtol=0.03)
    lawn = (0.1, 0.2, 0.05)
    assert SetGround(ground="scene").reflectance(lawn).rgb == pytest.approx(lawn)
    assert SetGround(ground="scene").reflectance(None) == GREY
    assert SetGround(ground="none").reflectance(lawn) == GREY
    assert SetGround(ground="grass").reflectance(lawn) == GRASS
    msgspec.structs.replace(SCENE, border_rgb=lawn).check()


def test_a_preset_has_its_own_ground():
    """Mars has no grass, and leaving it unsolved spares the work."""
    sky = above(BrunetonSky, preset="mars-like")
    before = albedo_of(sky)
    sky.tell(SetGround(ground="grass"))
    np.testing.assert_array_equal(albedo_of(sky), before)


def test_a_project_and_the_commands_name_the_ground(tmp_path):
    """NAME or NAME,ALBEDO, there and back."""
    for text in ("snow", "grass,0.15", "none"):
        assert parse_ground(text).text == text
        project = Project(scene="box.glb", ground=text)
        save_project(tmp_path / "it.toml", project)
        assert load_project(tmp_path / "it.toml").ground == text
    assert Project().ground == "scene"
    for text in ("moss", "snow,white", "snow,2", ""):
        with pytest.raises(UserError, match="ground"):
            parse_ground(text)
    before = Project(settings={"weather_sky": {"albedo": 0.3, "distribution": "cie-5"}})
    after = shared_options("--ground", "snow", project=before)[0]
    assert after.ground == "snow"
    assert after.settings == {"weather_sky": {"distribution": "cie-5"}}

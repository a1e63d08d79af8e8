"""Clouds of a project's instant, taken from its scene's kernel."""

from pathlib import Path

import msgspec
import numpy as np
import pytest
from epw_year import epw_text
from share.clouds_seen import clear_light, maps_of
from share.light_maps import behind_clouds, glow_illumination, illumination
from share.shared_scene import SharedScene
from share.sky_table import sky_table
from share.sun_places import SunPlaces

from vrut_lite.errors import UserError
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance
from vrut_lite.project import project_of_path, with_weather

SCENE = str(Path(__file__).parents[2] / "scenes" / "work" / "room.glb")
CUMULUS = {"clouds": {"genus": "Cu", "coverage": 0.4}}


def opened(**changes):
    project = project_of_path(SCENE)
    return SharedScene(msgspec.structs.replace(project, at="2026-06-21T12:30", **changes))


@pytest.fixture(scope="module")
def cumulus():
    """A scene, its clouds frozen, and the table of its sky."""
    scene = opened(settings=CUMULUS)
    try:
        frozen = scene.freeze_clouds()
        yield scene, frozen, sky_table(scene.sun_skies(np.radians([10.0, 30.0, 50.0])))
    finally:
        scene.close()


def test_the_scenes_own_skies_are_then_clear(cumulus):
    """A table of the sky's heights would turn the clouds with the sun."""
    scene, frozen, table = cumulus
    assert frozen.message.layers[0].coverage == 0.4
    assert scene.light.layers == ()
    clear = opened()
    try:
        assert clear.freeze_clouds() is None
        other = sky_table(clear.sun_skies(np.radians([10.0, 30.0, 50.0])))
    finally:
        clear.close()
    assert np.array_equal(table.radiance, other.radiance)


@pytest.mark.long
def test_maps_have_the_light_of_the_clouds_themselves(cumulus):
    """At suns between those that were seen: light of the sky on level ground to 8 %, the sun's
    rays, and radiance away from the sun to 20 % rms of its mean."""
    _, frozen, table = cumulus
    where = SunPlaces(np.radians(50.1), 0.0)
    night = glow_illumination(None, table.albedo_rgb[-1])
    black = (0.0, 0.0, 0.0)
    maps = maps_of(frozen, table, where, lambda rad: rad, night, black, lambda steps, _: steps)
    for height, azimuth in ((0.9, 3.3), (0.6, 4.4), (0.4, 1.7)):
        hour = illumination(table, height, height, azimuth)
        found = behind_clouds(hour, maps, maps.coefficients(height, azimuth) * table.level(height))
        truth = clouds_under(frozen, table, hour)
        above = texel_directions(64)[..., 1] > 0.0
        by_sky = horizontal_irradiance(truth * above[..., None])
        assert horizontal_irradiance(found.by_sky.sky * above[..., None]) == pytest.approx(
            by_sky, rel=0.08
        )
        off = (found.by_sky.sky - truth)[above][:, 1]
        sun = np.array(hour.key_direction)
        away = texel_directions(64)[above] @ sun < np.cos(np.radians(12.0))
        assert np.sqrt(np.mean(off[away] ** 2)) < 0.2 * truth[above][:, 1].mean()


def clouds_under(frozen, table, hour):
    """The sky's cube of an hour behind clouds, by the layer itself."""
    clear = clear_light(hour.sky.astype(float), sun_of(frozen, hour), (0.0, 0.0, 0.0))
    radiance = frozen.light_under(clear, 64).radiance
    return decode_float16(radiance.cube.values, radiance.radiance_scale)


def sun_of(frozen, hour):
    return msgspec.structs.replace(
        frozen.key_light,
        body="sun",
        direction=hour.key_direction,
        irradiance_rgb=hour.key_irradiance_rgb,
    )


def test_clouds_that_follow_the_weather_are_refused(tmp_path):
    """They are others in an hour; a page has one set of them."""
    path = tmp_path / "year.epw"
    path.write_text(epw_text())
    project = with_weather(project_of_path(SCENE), str(path))
    settings = {"clouds": {"follow_weather": True}}
    scene = SharedScene(msgspec.structs.replace(project, at="2023-06-21T09:00", settings=settings))
    try:
        with pytest.raises(UserError, match="follow the weather: choose them by --genus"):
            scene.freeze_clouds()
    finally:
        scene.close()

"""A year's skies from those of some sun heights, against skies made one by one."""

import numpy as np
import pytest
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.sky_cells import node_weights
from daylight_numbers.year.sun_height_skies import height_skies, spread_heights
from daylight_numbers.year.year_light import lit_hours, suns_of, year_light
from light_transport.rays.sky_nodes import GROUND_NODE, node_radiances

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.place import SetPlace
from vrut_lite.project import Project

ROOM = "scenes/work/room.glb"


def sky_of(height_rad, azimuth_rad):
    """A cube (6, 32, 32, 3) with a bright horizon, a glow around the sun, and dusk's fast fall."""
    directions = texel_directions(32)
    level = np.cos(height_rad)
    sun = [level * np.sin(azimuth_rad), np.sin(height_rad), -level * np.cos(azimuth_rad)]
    glow = 1.0 + np.exp(6.0 * (directions @ sun - 1.0)) + 0.5 * (1.0 - directions[..., 1]) ** 2
    light = np.exp(20.0 * min(height_rad, 0.3))
    return (light * glow[..., None] * [0.6, 0.8, 1.0]).astype(np.float32)


def test_a_sky_between_two_heights_is_the_sky_of_that_height_turned_to_its_sun():
    """Level illuminance within 0.3 %, the ray table's cells within 2 %, at any azimuth."""
    heights = np.radians(np.concatenate([np.arange(-5, 1, 0.25), np.arange(1, 40, 0.7)]))
    azimuths = np.linspace(-3.0, 9.0, len(heights))
    cubes = [sky_of(*angles) for angles in zip(heights, azimuths, strict=True)]
    nothing = np.zeros((len(heights), 3))
    sun = np.exp(heights)[:, None] * [1.0, 0.9, 0.8]
    skies = height_skies(heights, azimuths, cubes, nothing, sun)
    weights = node_weights()
    for height, azimuth in np.radians([[-4.1, 0.0], [0.4, 77.0], [12.3, 359.9], [38.0, 181.3]]):
        found, beam = skies.between(height, azimuth)
        truth = node_radiances(sky_of(height, azimuth), (0.0, 0.0, 0.0))[: GROUND_NODE + 1]
        np.testing.assert_allclose(found[:-1].T @ weights, truth[:-1].T @ weights, rtol=3e-3)
        np.testing.assert_allclose(found[:-1], truth[:-1], rtol=0.02)
        np.testing.assert_allclose(beam, np.exp(height) * np.array([1.0, 0.9, 0.8]), rtol=5e-3)


def test_heights_of_a_year_are_close_beside_each_other_and_few():
    """From the lowest sun to the highest, within a degree and half of it near the horizon."""
    place = SetPlace(latitude_deg=50.1, longitude_deg=14.4)
    height = suns_of(place, lit_hours(place, 1.0), 1.0).apparent_elevation_rad
    chosen = np.degrees(height[spread_heights(height)])
    assert chosen[0] == np.degrees(height.min())
    assert chosen[-1] == np.degrees(height.max())
    gaps = np.diff(chosen)
    assert (gaps > 0.0).all()
    assert gaps.max() < 1.1
    assert gaps[chosen[:-1] < 1.0].max() < 0.5
    assert len(chosen) < 120


@pytest.mark.long
@pytest.mark.parametrize("sky", ["bruneton_sky", "dynamic_skylight", "weather_sky"])
def test_a_year_has_the_light_of_its_hours_whatever_the_sky(sky):
    """Through the real kernel: clear skies by heights within 1 %, one that follows the day's
    weather hour by hour."""
    opened = OpenedScene(
        Project(scene=ROOM, at="2026-03-21T12:00", place="50.1,14.4", slots={"sky": sky})
    )
    hours = lit_hours(opened.place, 1.0)[::9]

    def years(some):
        return year_light(opened, some, 1.0, lambda numbers, _count: numbers)

    try:
        whole = years(hours)
        few = np.arange(0, len(hours), 13)
        one_by_one = years(hours[few])
    finally:
        opened.close()
    np.testing.assert_allclose(whole.sun_direction[few], one_by_one.sun_direction, atol=1e-6)
    np.testing.assert_allclose(whole.diffuse_lux[few], one_by_one.diffuse_lux, rtol=0.01)
    if sky == "weather_sky":
        np.testing.assert_array_equal(whole.sky[few], one_by_one.sky)

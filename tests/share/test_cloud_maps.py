"""Frozen clouds as maps of the hemisphere, against light of a known form."""

from dataclasses import replace

import numpy as np
import pytest
from share.cloud_maps import (
    COARSE,
    FINE,
    GLOW_NODES,
    PASSED_CODES,
    CloudSamples,
    bending,
    cloud_maps,
    glow_at,
    map_directions,
    sampled,
)
from share.shared_scene import direction_of
from share.sun_places import SunPlaces

PLACES = SunPlaces(0.87, 0.3, declinations=3, hours=24, dusk_azimuths=4)
COLOUR = np.array([1.0, 0.9, 0.7])
# P, which falls by e in two degrees: as bright as droplets make it.
ANGLE_DEG = 36.0 * np.linspace(0.0, 1.0, GLOW_NODES) ** 2
GLOW = 30.0 * np.exp(-0.5 * ANGLE_DEG)[:, None] * COLOUR


def passed(direction):
    """Transmittance of three clouds with soft edges."""
    x, _, z = direction.T
    return np.clip(0.5 + 0.9 * np.sin(4.0 * x + 1.0) * np.cos(3.0 * z), 0.0, 1.0)


def slow(direction, sun):
    """Light that clouds send to all sides, more of it towards the sun's side."""
    towards = 1.0 + 0.5 * direction @ sun
    return (0.2 * (1.0 - passed(direction)) * towards)[:, None] * COLOUR


@pytest.fixture(scope="module")
def seen():
    coarse = map_directions(COARSE).reshape(-1, 3)
    suns = np.array(
        [direction_of(a, h) for h, a in zip(PLACES.heights, PLACES.azimuths, strict=True)]
    )
    key = np.where(suns[:, 1] > 0.0, 0.8, 0.0)[:, None] * COLOUR
    bends = bending(passed(coarse))[:, None]
    light = [
        slow(coarse, sun) + bends * glow_at(GLOW, np.arccos(np.clip(coarse @ sun, -1, 1))) * own
        for sun, own in zip(suns, key, strict=True)
    ]
    return CloudSamples(coarse, suns, key, np.array(light), slow(coarse, suns[0]))


@pytest.fixture(scope="module")
def maps(seen):
    fine = passed(map_directions(FINE).reshape(-1, 3)).reshape(FINE, FINE)
    return cloud_maps(PLACES, seen, fine, fine)


@pytest.fixture(scope="module")
def upper():
    found = np.random.default_rng(2).normal(size=(3000, 3))
    found[:, 1] = np.abs(found[:, 1]) + 0.01
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def test_a_map_is_read_where_its_nodes_are(upper):
    """Over the whole hemisphere, within half the distance of nodes at the map's folds."""
    directions = map_directions(FINE)
    assert np.all(directions[..., 1] > 0.0)
    values = sampled(directions, upper)
    assert np.abs(values - upper).max() < 4e-3


def test_transmittance_keeps_its_small_values(maps, upper):
    """A ten-thousandth of the sun is as bright as a lamp: codes are even in the root."""
    found = maps.transmittance(upper)
    assert np.abs(found - passed(upper)).max() < 0.02
    codes = np.full_like(maps.passed, round(1e-2 * PASSED_CODES))
    assert replace(maps, passed=codes).transmittance(upper) == pytest.approx(1e-4, rel=0.01)


def test_the_glow_beside_the_sun_is_told_from_the_clouds_own_light(maps):
    """It moves with the sun between places; the clouds' own light does not."""
    angle = np.radians([0.5, 2.0, 4.0, 8.0])
    expected = glow_at(GLOW, angle)
    assert glow_at(maps.glow[0], angle) == pytest.approx(expected, rel=0.08, abs=0.4)


def test_between_places_of_the_sun_light_is_that_of_its_form(maps, upper):
    """Sky, clouds and glow add up, at a sun half way between places: rms 3 % of the mean."""
    height, north = 0.61, 2.0
    sun = np.array(direction_of(north - PLACES.north_offset_rad, height))
    clear = np.full((len(upper), 3), 0.1)
    found = maps.sky(upper, clear, maps.coefficients(height, north), [(sun, 0.8 * COLOUR)])
    angle = np.arccos(np.clip(upper @ sun, -1.0, 1.0))
    bends = bending(passed(upper))[:, None]
    true = clear * passed(upper)[:, None] + slow(upper, sun)
    true = true + bends * glow_at(GLOW, angle) * 0.8 * COLOUR
    assert np.sqrt(np.mean((found - true) ** 2)) < 0.03 * true.mean()
    assert found.min() >= 0.0


def test_the_night_has_the_clouds_own_light(maps, upper):
    found = maps.sky(upper, np.zeros((len(upper), 3)), maps.by_night, [])
    true = slow(upper, np.array(direction_of(PLACES.azimuths[0], PLACES.heights[0])))
    assert np.abs(found - true).max() < 0.05 * true.max()


def test_a_sky_without_clouds_is_left_as_it_is(seen, upper):
    """No light is taken or added, and nothing is divided by zero."""
    nothing = CloudSamples(
        seen.direction,
        seen.suns,
        seen.key,
        np.zeros_like(seen.light),
        np.zeros_like(seen.by_night),
    )
    open_sky = np.ones((FINE, FINE))
    maps = cloud_maps(PLACES, nothing, open_sky, open_sky)
    clear = np.random.default_rng(3).uniform(0.0, 2.0, (len(upper), 3))
    sun = np.array(direction_of(0.4, 0.5))
    found = maps.sky(upper, clear, maps.coefficients(0.5, 0.7), [(sun, COLOUR)])
    assert found == pytest.approx(clear, abs=1e-6)


def test_a_closed_layer_lets_no_sunlight_through(seen):
    dark = np.zeros((FINE, FINE))
    assert not cloud_maps(PLACES, seen, dark, dark).any_sun

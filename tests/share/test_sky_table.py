"""The table of the sky by the sun's height, against the skies that it was made from."""

import numpy as np
import pytest
from share.shared_scene import SunSky, direction_of
from share.sky_table import check_sky, sky_table

from vrut_lite.errors import UserError
from vrut_lite.geometry.cube_map import texel_directions

AZIMUTH = 2.3
HEIGHTS = np.radians([-12.0, -6.0, 0.0, 10.0, 30.0, 60.0])


def glow(direction, height, azimuth):
    """A sky with a glow 15 degrees wide about the sun, brighter towards the horizon."""
    sun = np.array(direction_of(azimuth, max(height, 0.0)))
    angle = np.arccos(np.clip(direction @ sun, -1.0, 1.0))
    bright = np.exp(8.0 * min(height, 0.0)) * (1.0 + 5.0 * np.exp(-angle / 0.26))
    value = bright * (1.0 + 2.0 * np.exp(-3.0 * np.maximum(direction[..., 1], 0.0)))
    return value[..., None] * np.array([1.0, 1.2, 1.6])


def sky(height, azimuth=AZIMUTH):
    cube = glow(texel_directions(64), height, azimuth).astype(np.float32)
    cube[texel_directions(64)[..., 1] <= 0.0] = 0.1
    key = np.full(3, max(np.sin(height), 0.0))
    return SunSky(height, height, azimuth, cube, key, np.full(3, 0.1), np.full(3, 0.2))


@pytest.fixture(scope="module")
def table():
    return sky_table([sky(height) for height in HEIGHTS])


@pytest.fixture(scope="module")
def upper():
    """Directions two degrees and more above the horizon: a cube's texels there are whole."""
    found = np.random.default_rng(1).normal(size=(4000, 3))
    found[:, 1] = np.abs(found[:, 1])
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    return found[found[:, 1] > 0.035]


@pytest.mark.parametrize("height", HEIGHTS)
def test_a_sky_of_the_table_is_the_one_it_was_made_from(table, upper, height):
    """Turned to another azimuth of the sun too: it depends on directions relative to the sun."""
    for azimuth in (AZIMUTH, AZIMUTH - 1.7):
        found = table.sky(upper, height, azimuth)
        true = glow(upper, height, azimuth)
        error = np.abs(found / true - 1.0)
        assert np.quantile(error, 0.99) < 0.02
        assert error.max() < 0.06


def test_between_heights_the_level_falls_by_its_logarithm(table):
    """In dusk light falls by a factor e in a few degrees: a line would be far too bright."""
    one, other = table.level(HEIGHTS[0]), table.level(HEIGHTS[1])
    assert table.level(0.5 * (HEIGHTS[0] + HEIGHTS[1])) == pytest.approx(np.sqrt(one * other))


def test_a_cube_has_the_grounds_radiance_below_the_horizon(table):
    cube = table.cube(16, HEIGHTS[3], 0.0)
    below = texel_directions(16)[..., 1] < 0.0
    assert cube[below] == pytest.approx(0.1, rel=1e-5)
    assert np.all(np.isfinite(cube))
    assert np.all(cube > 0.0)


def test_a_sky_that_does_not_turn_with_the_sun_is_refused(table):
    """A photograph, or clouds of an hour: the page would turn them."""
    check_sky(table, sky(0.6, AZIMUTH + 2.0))
    still = sky(0.6, AZIMUTH)
    turned = SunSky(**{**vars(still), "azimuth_rad": AZIMUTH + 2.0})
    with pytest.raises(UserError, match="depends on the sun's height alone"):
        check_sky(table, turned)

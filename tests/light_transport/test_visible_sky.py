"""Towards where texels see the sky, against what stands around them."""

import numpy as np
from boxes import floor, hour, quads
from light_transport.transport import SceneTransport


def seen_from(scene, rays=512, texels=8):
    """b and a (texels, texels, 4) of the first quad."""
    transport = SceneTransport(*scene)
    transport.add_rays(rays)
    return transport.light(hour(1.0)).visible_sky.values[:texels].astype(float)


def test_an_open_floor_sees_the_sky_everywhere():
    """a + b . d is 1 for any d above the floor, but for what rays are wide."""
    found = seen_from(quads(floor(0, 1, 0, 1)))
    np.testing.assert_allclose(found[..., :3], 0.0, atol=0.05)
    np.testing.assert_allclose(found[..., 3], 1.0, atol=0.05)


def test_at_the_foot_of_a_high_wall_the_sky_is_on_the_other_side():
    """A wall without end hides half of the hemisphere: the best line in x is 1/2 + (8 / 3 pi) x,
    for the mean of x over the visible half, cosine-weighted, is (2 / 3 pi), and of x^2 1 / 4."""
    wall = [[0, 0, 50], [0, 0, -50], [0, 100, -50], [0, 100, 50]]
    found = seen_from(quads(floor(0.001, 0.01, -0.005, 0.005), wall))
    np.testing.assert_allclose(found[..., 0].mean(), 8.0 / (3.0 * np.pi), rtol=0.02)
    np.testing.assert_allclose(found[..., 2].mean(), 0.0, atol=0.02)
    in_all = found[..., 3] + found[..., 1] * 2.0 / 3.0
    np.testing.assert_allclose(in_all, 0.5, atol=0.02)


def test_ground_beyond_the_map_is_below_the_horizon():
    """A wall sees sky above and open ground below, both far away: all around is open."""
    found = seen_from(quads([[0, 5, 0], [1, 5, 0], [1, 6, 0], [0, 6, 0]]))
    np.testing.assert_allclose(found[..., :3], 0.0, atol=0.15)
    np.testing.assert_allclose(found[..., 3], 1.0, atol=0.1)


def test_what_is_seen_of_the_sky_does_not_depend_on_the_hour():
    """One array for all hours of a round: the frame uploads it once."""
    transport = SceneTransport(*quads(floor(0, 1, 0, 1)))
    transport.add_rays(16)
    assert transport.light(hour(1.0)).visible_sky is transport.light(hour(2.0)).visible_sky

"""The sky's cells are small at the horizon, and what a cube map holds is in them."""

import numpy as np
import pytest
from light_transport.rays.sky_nodes import (
    EDGE,
    GROUND_NODE,
    NODES,
    disc_radius,
    node_directions,
    node_of,
    node_radiances,
    relative_solid_angle,
    sine_of_height,
)

from vrut_lite.geometry.cube_map import texel_directions, texel_solid_angles


def even_directions(count: int) -> np.ndarray:
    """Directions (count, 3) of equal solid angle over the upper hemisphere."""
    i = np.arange(count)
    y, angle = (i + 0.5) / count, 2.0 * np.pi * (i * 0.6180339887498949 % 1.0)
    r = np.sqrt(1.0 - y * y)
    return np.stack([r * np.cos(angle), y, r * np.sin(angle)], axis=1)


def test_cells_are_small_at_the_horizon_and_never_twice_the_mean():
    """Even directions count solid angles: all cells are met, those below go to the ground."""
    n = 400_000
    directions = even_directions(n)
    counts = np.bincount([node_of(*d) for d in directions], minlength=NODES)
    assert not counts[GROUND_NODE:].any()
    share = (counts[:GROUND_NODE] * (GROUND_NODE / n)).reshape(EDGE, EDGE)
    ring = np.maximum(*np.abs(np.indices(share.shape) - 0.5 * (EDGE - 1))) - 0.5
    means = [share[ring == k].mean() for k in range(EDGE // 2)]
    assert (np.diff(means) < 0.0).all()
    assert means[-1] < 0.5
    assert share.max() < 1.8
    low = directions[np.isin([node_of(*d) for d in directions], np.flatnonzero(ring.ravel() == 11))]
    assert np.degrees(np.arcsin(low[:, 1].max())) < 4.0
    below = np.bincount([node_of(x, -y, z) for x, y, z in directions[::9]], minlength=NODES)
    assert not below[:GROUND_NODE].any()
    assert below[GROUND_NODE:].all()


def test_the_disc_and_the_hemisphere_are_each_others_inverse():
    """Radius and sine return to themselves; the solid angle is the sine's own derivative."""
    radius = np.linspace(0.0, 1.0, 1001)
    np.testing.assert_allclose(disc_radius(sine_of_height(radius**2)), radius, atol=1e-7)
    step = 1e-6
    slope = (sine_of_height(radius**2 - step) - sine_of_height(radius**2 + step)) / (2.0 * step)
    np.testing.assert_allclose(relative_solid_angle(radius**2), slope, rtol=1e-8)


def test_a_cell_lies_where_its_directions_are():
    """The middle of a cell of the sky or the ground falls into that cell."""
    assert [node_of(*d) for d in node_directions()] == list(range(NODES))


def test_a_uniform_sky_is_uniform_in_all_cells():
    """The cube map's grid adds no error to any cell."""
    found = node_radiances(np.full((6, 64, 64, 3), 3.0, np.float32), (1.0, 2.0, 3.0))
    np.testing.assert_allclose(found[:GROUND_NODE], 3.0, rtol=1e-6)
    np.testing.assert_array_equal(found[GROUND_NODE:], [[1.0, 2.0, 3.0]] * (NODES - GROUND_NODE))


@pytest.mark.parametrize("size", [32, 64, 128])
def test_the_integral_over_the_sky_is_that_of_the_cube_map(size):
    """Radiance times solid angle over cells is the exact sum over texels of the upper half."""
    d = texel_directions(size)
    cube = (0.2 + np.maximum(d @ [0.5, 0.6, 0.62], 0.0) ** 8)[..., None] * np.ones(3)
    above = np.where(d[..., 1] > 0.0, texel_solid_angles(size)[None], 0.0)
    exact = np.einsum("fij,fijc->c", above, cube)
    directions = even_directions(100_000)
    solid = np.bincount([node_of(*d) for d in directions], minlength=GROUND_NODE)
    solid = solid * (2.0 * np.pi / len(directions))
    found = solid @ node_radiances(cube.astype(np.float32), (0, 0, 0))[:GROUND_NODE]
    np.testing.assert_allclose(found, exact, rtol=2e-3)

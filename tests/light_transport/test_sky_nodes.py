"""The sky's cells are of equal solid angle, and what a cube map holds is in them."""

import numpy as np
import pytest
from light_transport.rays.sky_nodes import (
    GROUND_NODE,
    NODES,
    node_directions,
    node_of,
    node_radiances,
)

from vrut_lite.geometry.cube_map import texel_directions, texel_solid_angles

CELL = 2.0 * np.pi / GROUND_NODE


def test_cells_have_equal_solid_angles():
    """Even directions on the hemisphere fall into all cells alike; those below go to the ground."""
    n = 400_000
    i = np.arange(n)
    y, angle = (i + 0.5) / n, 2.0 * np.pi * (i * 0.6180339887498949 % 1.0)
    r = np.sqrt(1.0 - y * y)
    directions = np.stack([r * np.cos(angle), y, r * np.sin(angle)], axis=1)
    counts = np.bincount([node_of(*d) for d in directions], minlength=NODES)
    assert not counts[GROUND_NODE:].any()
    np.testing.assert_allclose(counts[:GROUND_NODE], n / GROUND_NODE, rtol=0.05)
    below = np.bincount([node_of(x, -y, z) for x, y, z in directions[::9]], minlength=NODES)
    assert not below[:GROUND_NODE].any()
    np.testing.assert_allclose(below[GROUND_NODE:], n / 9 / (NODES - GROUND_NODE), rtol=0.05)


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
    found = node_radiances(cube.astype(np.float32), (0, 0, 0))[:GROUND_NODE].sum(axis=0) * CELL
    np.testing.assert_allclose(found, exact, rtol=2e-3)

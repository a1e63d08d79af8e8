"""Probes around what has no texels."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from light_transport.layout.probe_places import probe_grid, probe_places_m, without_buried

LENGTHS = st.floats(0.0, 1e6)


@given(st.tuples(LENGTHS, LENGTHS, LENGTHS), st.floats(1e-3, 1e3))
def test_a_box_of_any_size_gets_some_thousand_probes_at_most(size, step):
    """Two or more along each axis, and none outside a box that is no sheet."""
    lower = np.array([5.0, -3.0, 1e4])
    grid = probe_grid(lower, lower + size, step)
    grid.check()
    assert 8 <= np.prod(grid.counts) <= 2048
    places = probe_places_m(grid)
    assert places.shape == (*grid.counts[::-1], 3)
    outside = np.maximum(lower - places, places - lower - size).max(axis=(0, 1, 2))
    thick = np.array(size) > 0.01 * np.max(grid.step_m)
    assert (outside[thick] <= 1e-9 * np.max(size)).all()


def test_probes_are_numbered_x_first():
    """As the light that comes back for them: (nz, ny, nx)."""
    grid = probe_grid(np.zeros(3), np.array([8.0, 4.0, 2.0]), 1.0)
    places = probe_places_m(grid)
    np.testing.assert_allclose(places[0, 0, 1] - places[0, 0, 0], (grid.step_m[0], 0, 0))
    np.testing.assert_allclose(places[1, 0, 0] - places[0, 0, 0], (0, 0, grid.step_m[2]))


def test_buried_probes_take_their_neighbours_light():
    """Within a wall, between a bright and a dark room, each side has its own light."""
    light = np.zeros((2, 2, 6, 6, 4), np.float32)
    light[:, :, :2], light[:, :, 4:] = 8.0, 2.0
    buried = np.zeros((2, 2, 6), bool)
    buried[:, :, 2:4] = True
    found = without_buried(light, buried)
    assert found[0, 0, :, 0, 0] == pytest.approx([8, 8, 8, 2, 2, 2])
    assert light[0, 0, 2, 0, 0] == 0.0
    np.testing.assert_array_equal(without_buried(light, np.ones_like(buried)), light)

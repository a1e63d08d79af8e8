"""The land that the terrain is made of: its mesh, its water and its slopes."""

import numpy as np
import pytest

from vrut_lite_lab.scenes.adaptive_mesh import adaptive_triangles
from vrut_lite_lab.scenes.erosion import drainage, drained_cells, erode
from vrut_lite_lab.scenes.noise import gradient_noise


def test_triangles_are_small_only_where_asked_and_meet_edge_to_edge():
    """A mesh refined at one corner has no hanging vertex and covers its square."""
    points, faces = adaptive_triangles(64, lambda c: c.min(axis=(1, 2)) < 3)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edge, times = np.unique(edges, axis=0, return_counts=True)
    ends = points[edge[times == 1]]
    assert times.max() == 2
    assert np.all([np.any(np.all((e == 0) | (e == 64), axis=0) & (e[0] == e[1])) for e in ends])
    a, b, c = np.moveaxis(points[faces], 1, 0)
    area = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2.0
    assert abs(area.sum()) == 64 * 64
    assert np.abs(area).min() == 0.5
    assert np.abs(area).max() > 100


@pytest.mark.long
def test_water_runs_down_and_none_is_lost():
    """With hollows filled each cell drains downwards, and all cells drain to the border."""
    x, z = np.meshgrid(np.arange(24) / 5.0, np.arange(24) / 5.0)
    land = 50.0 + 30.0 * gradient_noise(x + 0.1, z + 0.1, 3)
    order, below, filled = drainage(land)
    flat = filled.ravel()
    inner = below != np.arange(below.size)
    assert np.all(flat[below[inner]] < flat[inner])
    assert drained_cells(order, below)[~inner].sum() == land.size


@pytest.mark.long
def test_eroded_land_reaches_the_slope_of_its_rivers():
    """In a steady state slope = uplift / (strength sqrt(area)) (Braun and Willett 2013, eq. 1)."""
    size, spacing_m, rise_m, strength = 24, 100.0, 2.0, 0.5
    uplift = np.full((size, size), rise_m)
    limit = np.full((size, size), 1e6)
    x, z = np.meshgrid(np.arange(size), np.arange(size))
    start = gradient_noise(x / 4.0 + 0.1, z / 4.0 + 0.1, 1)
    start[[0, -1]] = 0.0
    start[:, [0, -1]] = 0.0
    land = erode(start, uplift, limit, spacing_m, strength, 400)
    order, below, _ = drainage(land)
    cells = drained_cells(order, below)
    inner = np.flatnonzero(below != np.arange(below.size))
    lower = below[inner]
    straight = (lower // size == inner // size) | (lower % size == inner % size)
    run_m = np.where(straight, spacing_m, np.sqrt(2.0) * spacing_m)
    slope = (land.ravel()[inner] - land.ravel()[lower]) / run_m
    expected = rise_m / (strength * np.sqrt(cells[inner]) * spacing_m)
    np.testing.assert_allclose(slope, expected, rtol=1e-3)

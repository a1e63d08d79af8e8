"""Linear look-ups: exact at nodes and on what is linear, constant beyond the edge."""

import numpy as np
import pytest
from bruneton_sky.tables.coordinates import node_coordinates, texture_coordinate
from bruneton_sky.tables.interpolate import interpolate

SHAPE = (3, 4, 2, 5)


def test_multilinear_function_is_exact() -> None:
    """A product of lines is its own four-linear interpolation, between nodes too."""
    grids = np.ix_(*(np.arange(n) + 1.0 for n in SHAPE))
    table = np.stack([np.prod(np.broadcast_arrays(*grids), axis=0), sum(grids)], axis=-1)
    places = np.random.default_rng(1).random((100, 4))
    at = [texture_coordinate(places[:, k], n) for k, n in enumerate(SHAPE)]
    where = 1.0 + places * (np.array(SHAPE) - 1)
    truth = np.stack([where.prod(axis=1), where.sum(axis=1)], axis=-1)
    assert interpolate(table, at) == pytest.approx(truth, rel=1e-13)


def test_nodes_come_back_and_the_edge_holds() -> None:
    """At texel centres the table itself; outside the outermost ones their values."""
    table = np.random.default_rng(2).random((*SHAPE, 3))
    assert interpolate(table, np.ix_(*map(node_coordinates, SHAPE))) == pytest.approx(table)
    corner = interpolate(table, [np.array(v) for v in (0.0, 1.0, 0.0, 1.0)])
    assert corner == pytest.approx(table[0, -1, 0, -1])

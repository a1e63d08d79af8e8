"""Look-ups: exact at nodes and on what is linear, and by cubics along the suns; constant beyond."""

import numpy as np
import pytest
from bruneton_sky.tables.interpolate import interpolate, interpolate_suns
from bruneton_sky.tables.parametrisations import node_coordinates, texture_coordinate
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

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


def test_parabolas_of_the_sun_are_exact() -> None:
    """Along the last axis a monotone parabola comes back between all nodes, at both ends too; along
    the others a line does."""
    grids = np.ix_(*(np.arange(n) + 1.0 for n in SHAPE))
    table = (grids[0] * grids[1] * grids[2] * (grids[3] + 3.0) ** 2)[..., None]
    places = np.random.default_rng(3).random((200, 4))
    at = [texture_coordinate(places[:, k], n) for k, n in enumerate(SHAPE)]
    where = 1.0 + places * (np.array(SHAPE) - 1)
    truth = where[:, :3].prod(axis=1) * (where[:, 3] + 3.0) ** 2
    (found,) = interpolate_suns((table,), at)
    assert found[:, 0] == pytest.approx(truth, rel=1e-12)


@given(arrays(float, (6, 2), elements=st.floats(0.0, 1.0) | st.sampled_from([0.0, 1e-9, 1.0])))
@settings(max_examples=100)
def test_cubics_stay_between_their_nodes(table: NDArray[np.float64]) -> None:
    """No value is above or below both nodes beside it: none is negative."""
    share = np.linspace(0.0, 1.0, 7)
    for before in range(5):
        suns = (before + share + 0.5) / 6
        (found,) = interpolate_suns((np.stack([table, table]),), [np.array(0.25), suns])
        low, high = np.sort(table[before : before + 2], axis=0)
        assert np.all((found >= 0.0) & (found >= low - 1e-12) & (found <= high + 1e-12))
        assert found[[0, -1]] == pytest.approx(table[before : before + 2], abs=1e-12)


def test_suns_beyond_the_ends_are_those_at_the_ends() -> None:
    """As for lines; and several tables are looked up as one by one."""
    tables = tuple(np.random.default_rng(4).random((2, *SHAPE, 3)))
    at = [np.array([0.3]), np.array([0.6]), np.array([0.5]), np.array([0.0, 1.0])]
    ends = interpolate(tables[0], [*at[:3], np.array([0.5 / SHAPE[3], 1.0 - 0.5 / SHAPE[3]])])
    both = interpolate_suns(tables, at)
    assert both[0] == pytest.approx(ends)
    for table, found in zip(tables, both, strict=True):
        assert np.array_equal(interpolate_suns((table,), at)[0], found)

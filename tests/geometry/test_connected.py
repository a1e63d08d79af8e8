"""Connected components are those that scipy finds, numbered alike."""

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components as of_scipy

from vrut_lite.geometry.connected import connected_components


@pytest.mark.parametrize(("nodes", "links"), [(0, 0), (5, 0), (10, 4), (900, 400), (900, 2000)])
def test_components_are_scipys(nodes, links):
    """Random graphs, sparse and dense, fall into the same components in the same order."""
    first, second = np.random.default_rng(nodes + links).integers(0, max(nodes, 1), (2, links))
    graph = coo_matrix((np.ones(links, bool), (first, second)), (nodes, nodes))
    expected = of_scipy(graph, directed=False)[1]
    np.testing.assert_array_equal(connected_components(nodes, first, second), expected)


def test_a_long_chain_is_one_component():
    """Links in any order join a chain of 10,000 nodes."""
    links = np.random.default_rng(1).permutation(9999)
    assert not connected_components(10_000, links + 1, links).any()

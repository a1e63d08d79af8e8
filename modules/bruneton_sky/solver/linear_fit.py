"""Node values whose linear interpolation keeps what lies between the nodes.

A table with the function's own values at its nodes is too large between them wherever the function
is hollow, as it is beside the lobe that haze scatters forward. The lines that are nearest to the
function in the mean square keep its integral, and err to either side.
"""

from collections.abc import Callable

import numpy as np

from vrut_lite.numeric_types import FloatArray

# Gauss points between neighbouring nodes: harmonics of degree 32 bend little there.
_POINTS = 8


def fit_lines(
    function: Callable[[FloatArray], FloatArray],
    node: FloatArray,
    place: Callable[[FloatArray], FloatArray],
    keep_ends: bool = False,
) -> FloatArray:
    """Values (n, k) at nodes (n,) that fit a function best where lines connect them.

    Args:
        function: of a coordinate (m,), to (m, k).
        node: the coordinate at the nodes, over which the squared difference is integrated.
        place: of a coordinate, what the lines are straight over; uniform from 0 to 1 at the nodes.
        keep_ends: leave the function's own values at the first and the last node.
    """
    root, weight = np.polynomial.legendre.leggauss(_POINTS)
    half = 0.5 * np.diff(node)[:, None]
    x = (0.5 * (node[:-1] + node[1:])[:, None] + half * root).ravel()
    index = np.arange(node.size)
    share = np.maximum(1.0 - np.abs(place(x)[:, None] * (node.size - 1) - index), 0.0)
    weighted = share.T * (half * weight).ravel()
    if not keep_ends:
        return np.asarray(np.linalg.solve(weighted @ share, weighted @ function(x)), float)
    values = function(node)
    free, ends = weighted[1:-1], share[:, [0, -1]]
    rest = function(x) - ends @ values[[0, -1]]
    values[1:-1] = np.linalg.solve(free @ share[:, 1:-1], free @ rest)
    return values

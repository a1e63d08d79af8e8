"""Towards where texels see the sky: what a coat mirrors of it, and where things stand before it.

Open ground beyond the map counts as sky here. From a texel the share of it that is seen in direction d is held to be a + b . d, whose moments
over the cosine-weighted hemisphere are those of the texel's rays: no light is needed to know them.
"""

import numpy as np

from light_transport.rays.sky_nodes import NODES, node_directions
from vrut_lite.numeric_types import Float32Array


def sky_moments(columns: int) -> Float32Array:
    """What a ray brings from each column (C, 4): of a node its direction and 1."""
    found = np.zeros((columns, 4), np.float32)
    found[:NODES, :3] = node_directions()
    found[:NODES, 3] = 1.0
    return found


def visible_sky(moments: Float32Array, normals: Float32Array) -> Float32Array:
    """Coefficients (N, 4), b and then a, by means over rays (N, 4) of `sky_moments`.

    Of cosine-weighted rays on the hemisphere around n (N, 3) the means of 1, d.n, (d.n)^2 and
    (d.t)^2, t across n, are 1, 2/3, 1/2 and 1/4.
    """
    share = moments[:, 3]
    up = np.einsum("ni,ni->n", moments[:, :3], normals)
    across = moments[:, :3] - up[:, None] * normals
    b_up = 9.0 * (up - share * (2.0 / 3.0))
    found = np.empty_like(moments)
    found[:, :3] = 4.0 * across + b_up[:, None] * normals
    found[:, 3] = share - (2.0 / 3.0) * b_up
    return found


"""The directions in which texels see the sky, for reflections in coats.

Open ground beyond the map counts as sky here. The share of it that a texel sees in direction d is
held to be a + b . d, after the means of the texel's rays: no light is needed to know them.
"""

import numpy as np

from light_transport.rays.sky_nodes import NODES, node_directions
from vrut_lite.numeric_types import Float32Array

# Of cosine-weighted directions on the hemisphere around n the means of d.n, (d.n)^2 and, t across
# n, (d.t)^2. They ask for b along n 18 times the sky's excess there: half of it is taken, for a
# window is no line, and noise grows as much.
_UP, _UP_AGAIN, _ACROSS_AGAIN = 2.0 / 3.0, 1.0 / 2.0, 1.0 / 4.0
_TAKEN = 0.5


def sky_moments(columns: int) -> Float32Array:
    """The moments (C, 4) of each column: a node's direction and 1, zeros for a patch."""
    found = np.zeros((columns, 4), np.float32)
    found[:NODES, :3] = node_directions()
    found[:NODES, 3] = 1.0
    return found


def visible_sky(moments: Float32Array, normals: Float32Array) -> Float32Array:
    """b and a (N, 4) of texels with normals (N, 3), by means over rays (N, 4) of `sky_moments`."""
    share = moments[:, 3]
    up = np.einsum("ni,ni->n", moments[:, :3], normals)
    across = moments[:, :3] - up[:, None] * normals
    b_up = _TAKEN / (_UP_AGAIN - _UP**2) * (up - share * _UP)
    found = np.empty_like(moments)
    found[:, :3] = across / _ACROSS_AGAIN + b_up[:, None] * normals
    found[:, 3] = share - _UP * b_up
    return found

"""Towards where texels see the sky: what a coat mirrors of it, and where things stand before it.

From a texel the share of the sky that is seen in direction d is held to be a + b . d, whose moments
over the cosine-weighted hemisphere are those of the texel's rays: no light is needed to know them.
"""

from functools import lru_cache

import numpy as np

from light_transport.rays.sky_nodes import GROUND_NODE, node_radiances
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.numeric_types import Float32Array

_CUBE_TEXELS = 64


def sky_moments(columns: int) -> Float32Array:
    """What a ray brings from each column (C, 4): of a cell of the sky its direction and 1."""
    found = np.zeros((columns, 4), np.float32)
    found[:GROUND_NODE, :3] = _cell_directions()
    found[:GROUND_NODE, 3] = 1.0
    return found


def visible_sky(moments: Float32Array, normals: Float32Array) -> Float32Array:
    """Coefficients (N, 4), b and then a, by means over rays (N, 4) of `sky_moments`.

    Of cosine-weighted rays on the hemisphere around n (N, 3) the means of 1, d.n, (d.n)^2 and
    (d.t)^2, t across n, are 1, 2/3, 1/2 and 1/4.
    """
    share = moments[:, 3]
    up = np.einsum("ni,ni->n", moments[:, :3], normals)
    across = moments[:, :3] - up[:, None] * normals
    b_up = 18.0 * (up - share * (2.0 / 3.0))
    found = np.empty_like(moments)
    found[:, :3] = 4.0 * across + b_up[:, None] * normals
    found[:, 3] = share - (2.0 / 3.0) * b_up
    return found


@lru_cache(maxsize=1)
def _cell_directions() -> Float32Array:
    """Unit vectors (EDGE^2, 3) to the middles of the cells."""
    means = node_radiances(texel_directions(_CUBE_TEXELS).astype(np.float32), (0.0,) * 3)
    found = means[:GROUND_NODE]
    return (found / np.linalg.norm(found, axis=1, keepdims=True)).astype(np.float32)

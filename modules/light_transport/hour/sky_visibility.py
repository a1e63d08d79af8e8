"""The open sky on surfaces of any orientation, and the directions in which texels see the sky.

The latter are for reflections in coats; open ground beyond the map counts as sky there. The share
of the sky that a texel sees in direction d is modelled as a + b . d, by the means of the texel's
rays: no light is needed to know it.
"""

from functools import lru_cache

import numpy as np

from light_transport.kernels import hot
from light_transport.rays.orientations import middle_normals
from light_transport.rays.sky_nodes import NODES, node_directions
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.spherical_harmonics import basis
from vrut_lite.numeric_types import Float32Array, FloatArray

# Means of d.n, (d.n)^2 and, t across n, (d.t)^2, over cosine-weighted directions d above n. By them
# b along n is 18 times the sky's excess there; half of it is taken, for a window is no line, and
# noise grows as much.
_UP, _UP_AGAIN, _ACROSS_AGAIN = 2.0 / 3.0, 1.0 / 2.0, 1.0 / 4.0
_TAKEN = 0.5


def open_luminance(open_sky: FloatArray) -> Float32Array:
    """Luminance of irradiance (cells,) under open sky, by its harmonics (25, 3); above 0."""
    light = luminance(_basis() @ np.asarray(open_sky, np.float64))
    return np.maximum(light, 1e-30).astype(np.float32)


@hot
def scaled(light, factor, cell):  # type: ignore[no-untyped-def]
    """Multiply light (N, 4) by the factors (cells,) of its orientations (N,) or more."""
    for i in range(len(light)):
        for k in range(4):
            light[i, k] *= factor[cell[i]]


@hot
def to_shares(light, open_sky, cell):  # type: ignore[no-untyped-def]
    """Divide alpha of light (N, 4) by the luminance (cells,) of the open sky; at most 1."""
    for i in range(len(light)):
        share = light[i, 3] / open_sky[cell[i]]
        light[i, 3] = min(max(share, np.float32(0.0)), np.float32(1.0))


@lru_cache(maxsize=1)
def _basis() -> FloatArray:
    """Harmonics (cells, 25) at the middles of all cells."""
    return basis(middle_normals())


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

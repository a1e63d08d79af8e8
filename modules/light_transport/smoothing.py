"""Noise is smoothed along surfaces, where light cannot change fast.

How fast it can is told by the harmonic mean distance R to what a texel sees (Ward and Heckbert
1992): each step mixes neighbours by min(g_i, g_j), g = min(1, 0.3 R / h)^2, h the texel. What one
gives the other takes, so that no light is lost.

"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import hot, kernel
from light_transport.map_texels import Texels
from vrut_lite.numeric_types import BoolArray, Float32Array

STEPS = 8
_SHARE_OF_ROOM = 0.3
# With four neighbours the texel itself keeps as much as each of them gives.
_MOST = 0.2
_ALIKE_POWER = 8


class Smoothing(NamedTuple):
    """Weights (N, 4) float32 of the links (N, 4) int32 of texels; 0 where there is none."""

    links: NDArray[np.int32]
    weights: Float32Array


def smoothing_of(
    texels: Texels, links: NDArray[np.int32], good: BoolArray, room: Float32Array
) -> Smoothing:
    """Weights for good texels (N,) around which there is so much room (N,), in radii."""
    gate = np.minimum(1.0, _SHARE_OF_ROOM * room / np.maximum(texels.width, 1e-12)) ** 2
    weights = _weights(links, texels.normal, texels.area, gate.astype(np.float32), good)
    # A link of no weight leads to the texel itself: kernels need not ask.
    own = np.arange(len(links), dtype=np.int32)[:, None]
    return Smoothing(np.where(weights > 0.0, links, own).astype(np.int32), weights)


@kernel
def _weights(links, normal, area, gate, good):  # type: ignore[no-untyped-def]
    weights = np.zeros(links.shape, np.float32)
    for i in range(len(links)):
        for k in range(links.shape[1]):
            j = links[i, k]
            if j < 0 or not good[i] or not good[j]:
                continue
            alike = 0.0
            for axis in range(3):
                alike += normal[i, axis] * normal[j, axis]
            if alike > 0.0 and area[i] > 0.0:
                exchange = min(gate[i], gate[j]) * alike**_ALIKE_POWER * min(area[i], area[j])
                weights[i, k] = _MOST * exchange / area[i]
    return weights


@hot
def smoothed_rows(light, out, smoothing, first, last):  # type: ignore[no-untyped-def]
    """One step: rows `first` to `last` of light (N, 4) into `out`."""
    links, weights = smoothing.links, smoothing.weights
    for i in range(first, last):
        a, b, c, d = links[i, 0], links[i, 1], links[i, 2], links[i, 3]
        wa, wb, wc, wd = weights[i, 0], weights[i, 1], weights[i, 2], weights[i, 3]
        own = np.float32(1.0) - wa - wb - wc - wd
        for k in range(4):
            out[i, k] = (
                own * light[i, k]
                + wa * light[a, k]
                + wb * light[b, k]
                + wc * light[c, k]
                + wd * light[d, k]
            )

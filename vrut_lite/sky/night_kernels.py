"""Cubes of the night, compiled: the glow's look-up, and the sum of cubes."""

import numpy as np

from vrut_lite.njit import SUMS_IN_ORDER, njit

_compiled = njit(cache=True, nogil=True, fastmath=SUMS_IN_ORDER)
# Bits of a half at a float32's place, where they are that value times 2^-112.
_SHIFT, _REBIAS = np.uint32(13), np.float32(2.0**112)


@_compiled
def fill_glow(cube, upper, nodes, weights, light, ground):  # type: ignore[no-untyped-def]
    """Write the sum of four weighted nodes of `light` (n, 3) to each upper texel (m,), rising, and
    `ground` (3,) to the others of the cube (texels, 3)."""
    red, green, blue, k = ground[0], ground[1], ground[2], 0
    for i in range(cube.shape[0]):
        if k == upper.size or upper[k] != i:
            cube[i, 0], cube[i, 1], cube[i, 2] = red, green, blue
            continue
        for c in range(3):
            cube[i, c] = (
                weights[k, 0] * light[nodes[k, 0], c]
                + weights[k, 1] * light[nodes[k, 1], c]
                + weights[k, 2] * light[nodes[k, 2], c]
                + weights[k, 3] * light[nodes[k, 3], c]
            )
        k += 1


@_compiled
def add_halves(total, halves, factor):  # type: ignore[no-untyped-def]
    """Add `factor` (3,) times values at least 0, bits (n, 3) of halves, to `total` (n, 3)."""
    factors = factor[0] * _REBIAS, factor[1] * _REBIAS, factor[2] * _REBIAS
    for i in range(total.shape[0]):
        for c in range(3):
            total[i, c] += factors[c] * np.uint32(halves[i, c] << _SHIFT).view(np.float32)

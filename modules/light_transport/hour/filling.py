"""Gives texels inside bodies a neighbour's light: look-ups at a body's foot mix them in."""

from typing import cast

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import kernel
from light_transport.surfaces.map_texels import NOBODY
from vrut_lite.numeric_types import BoolArray, Float32Array


def takes_light_of(
    links: NDArray[np.int32], good: BoolArray, free: Float32Array
) -> NDArray[np.int32]:
    """The texel whose light each texel (N,) shows: itself if good, else the nearest good one.

    Of two equally near ones that with more of its rays `free` (N,): under a wall that is two
    texels thick it is the one that look-ups beside the wall need. NOBODY where there is none.
    """
    return cast(NDArray[np.int32], _takes(links, good, free))


@kernel
def _takes(links, good, free):  # type: ignore[no-untyped-def]
    count = len(links)
    source = np.full(count, NOBODY, np.int32)
    for i in range(count):
        if good[i]:
            source[i] = i
    while True:
        found = source.copy()
        some = False
        for i in range(count):
            if source[i] >= 0:
                continue
            best = NOBODY
            for k in range(links.shape[1]):
                j = links[i, k]
                if j < 0 or source[j] < 0:
                    continue
                if best < 0 or free[source[j]] > free[best]:
                    best = source[j]
            if best >= 0:
                found[i] = best
                some = True
        if not some:
            return source
        source = found

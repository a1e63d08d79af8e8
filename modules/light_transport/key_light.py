"""Which share of the key light falls on texels: for its bounces, as the frame draws it itself."""

import numpy as np

from light_transport.kernels import dot, kernel
from light_transport.ray_starts import begin
from light_transport.ray_table import TRIED
from light_transport.trace import MISS, blocker, mixed
from light_transport.tree import STACK

# A group has no other rows whose rays are averaged with its own.
_RAYS_OF_A_GROUP = 8


@kernel
def lit_shares(tree, receivers, free_start, direction, first, last, out):  # type: ignore[no-untyped-def]
    """Fill out[first:last] with visible share times cosine of a direction (3,), unit.

    A texel has one ray, from anywhere in it: a patch has the mean of its texels. `free_start`
    (N,) uint8: a ray of each row that began outside bodies, or TRIED for none.
    """
    stack = np.empty(STACK, np.int32)
    place, normal, face = np.empty(3), np.empty(3), np.empty(3)
    x, y, z = np.float32(direction[0]), np.float32(direction[1]), np.float32(direction[2])
    texels, probes = len(receivers.texels.pixel), len(receivers.probes.place)
    likely = MISS
    for row in range(first, last):
        out[row] = 0.0
        if texels <= row < texels + probes or free_start[row] >= TRIED:
            continue
        rays = 1 if row < texels else _RAYS_OF_A_GROUP
        total = 0.0
        for s in range(rays):
            begin(receivers, row, s if rays > 1 else free_start[row], place, normal, face)
            cosine = dot(face, direction)
            if cosine <= 0.0:
                continue
            found = blocker(
                tree,
                np.float32(place[0]),
                np.float32(place[1]),
                np.float32(place[2]),
                x,
                y,
                z,
                mixed(row, s),
                stack,
                likely,
            )
            if found == MISS:
                total += cosine
            else:
                likely = found
        out[row] = total / rays

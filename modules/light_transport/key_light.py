"""Which share of the key light falls on texels: for its bounces, as the frame draws it itself."""

import numpy as np

from light_transport.kernels import hot
from light_transport.ray_starts import begin, shift
from light_transport.ray_table import TRIED
from light_transport.trace import MISS, blocker, mixed

# A group has no other rows whose rays are averaged with its own.
_RAYS_OF_A_GROUP = 8


@hot
def lit_shares(tree, receivers, free_start, direction, scratch, first, last, out):  # type: ignore[no-untyped-def]
    """Fill out[first:last] with visible share times cosine of a direction (3,), unit.

    A texel has one ray, from anywhere in it: a patch has the mean of its texels. `free_start`
    (N,) uint8: a ray of each row that began outside bodies, or TRIED for none.
    """
    stack, _, _, shifts, weights, place, normal, face, _ = scratch
    x, y, z = np.float32(direction[0]), np.float32(direction[1]), np.float32(direction[2])
    geometry, texels, probes, groups = receivers
    first_probe = len(texels.pixel)
    first_group = first_probe + len(probes.place)
    likely = MISS
    for row in range(first, last):
        out[row] = 0.0
        if first_probe <= row < first_group or free_start[row] >= TRIED:
            continue
        rays = 1 if row < first_probe else _RAYS_OF_A_GROUP
        shift(row, shifts)
        total = 0.0
        for s in range(rays):
            number = s if rays > 1 else free_start[row]
            begin(
                geometry, texels, probes, groups, row, number, shifts, weights, place, normal, face
            )
            cosine = face[0] * direction[0] + face[1] * direction[1] + face[2] * direction[2]
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

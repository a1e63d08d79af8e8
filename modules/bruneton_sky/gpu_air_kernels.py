"""Slices of the air as air_volume.comp reads them: what all columns of a row share.

Importing this module imports numba.
"""

import math

from bruneton_sky.air_volume_kernels import NEGLIGIBLE
from bruneton_sky.solver.altitude_kernels import altitude_place
from bruneton_sky.solver.cells_kernels import fast

SLICE_FLOATS = 32


@fast
def pack_slices(air, distance, centre, weight, colour, out):  # type: ignore[no-untyped-def]
    """Fill `out` (rows, slices, SLICE_FLOATS), zeros, in the order of the shader's `Slice`.

    Arguments as for `light_rows`.
    """
    ground, top = air.ground_radius_m, air.top_altitude_m
    whole = top * (2.0 * ground + top)
    for i in range(out.shape[0]):
        mass = 0.0
        for k in range(out.shape[1]):
            here, packed = centre[i, k], out[i, k]
            for c in range(4):
                for channel in range(3):
                    packed[20 + 4 * channel + c] = colour[i, k, c, channel]
            mass += here[3]
            if here[3] > NEGLIGIBLE * mass:
                altitude, mu = here[1], here[2]
                r, squared = ground + altitude, altitude * (2.0 * ground + altitude)
                span = (math.sqrt(squared) + math.sqrt(whole) - (top - altitude)) / r
                packed[0], packed[1], packed[2] = here[0], distance[i, k], distance[i, k + 1]
                packed[3] = 1.0
                packed[4], packed[5] = 1.0 / r, mu
                packed[6] = 1.0 / math.sqrt(max((1.0 - mu) * (1.0 + mu), 1e-9))
                packed[7] = altitude_place(air, altitude)
                packed[8] = (whole - squared) / (r * r)
                packed[9], packed[10] = (top - altitude) / r, 1.0 / span
                for c in range(4):
                    packed[12 + c], packed[16 + c] = weight[i, k, 0, c], weight[i, k, 1, c]

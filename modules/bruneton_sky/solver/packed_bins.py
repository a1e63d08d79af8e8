"""Bins of a ray in the layout of shaders: `Bin` of scattered_light.glsl.

Importing this module imports numba.
"""

import math

from bruneton_sky.solver.cell_kernels import inner
from bruneton_sky.solver.first_order_kernels import share_particles
from bruneton_sky.solver.ray_kernels import altitude_place

# Numbers of a bin in a shader's buffer.
BIN_FLOATS = 32


@inner
def pack_bin(air, start, stop, centre, weight, share, packed):  # type: ignore[no-untyped-def]
    """Fill the first BIN_FLOATS numbers of `packed`; `share` (4, 4) is scratch.

    `start`, `stop`: distances in m. `centre` (4,), `weight` (2, 4): see `Bins`.
    """
    ground, top = air.ground_radius_m, air.top_altitude_m
    whole = top * (2.0 * ground + top)
    altitude, mu = centre[1], centre[2]
    r, squared = ground + altitude, altitude * (2.0 * ground + altitude)
    span = (math.sqrt(squared) + math.sqrt(whole) - (top - altitude)) / r
    packed[0], packed[1], packed[2], packed[3] = centre[0], start, stop, 1.0
    packed[4], packed[5] = 1.0 / r, mu
    packed[6] = 1.0 / math.sqrt(max((1.0 - mu) * (1.0 + mu), 1e-9))
    packed[7] = altitude_place(air, altitude)
    packed[8] = (whole - squared) / (r * r)
    packed[9], packed[10] = (top - altitude) / r, 1.0 / span
    share_particles(air, altitude, share)
    for c in range(4):
        packed[12 + c], packed[16 + c] = weight[0, c], weight[1, c]
        packed[20 + c], packed[24 + c], packed[28 + c] = share[1, c], share[2, c], share[3, c]

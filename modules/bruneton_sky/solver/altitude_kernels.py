"""Where altitudes lie on the axis of the solver's tables, for compiled code.

In clear air they are uniform in sqrt(r^2 - Rg^2). A dense layer, fog or haze, adds nodes of its
own, uniform in 1 - exp(-altitude / layer_reach_m): the axis is a blend of both with layer_share of
it for the layer, and has so many nodes that the clear air keeps as many as it would have alone.

Importing this module imports numba.
"""

import math

import numpy as np

from bruneton_sky.solver.cells_kernels import fast, inner

# Halvings of the whole air until nothing is left of it: 60 km over 2^50 is below a nanometre.
_HALVINGS = 50


def nodes_of_axis(count: int, layer_share: float) -> int:
    """How many nodes an axis has that would have `count` in clear air."""
    return math.ceil((count - 1) / (1.0 - layer_share)) + 1


@inner
def altitude_place(air, altitude):  # type: ignore[no-untyped-def]
    """Place in [0, 1] of an altitude, 1 at the top."""
    ground, top = air.ground_radius_m, air.top_altitude_m
    squared = altitude * (2.0 * ground + altitude) / (top * (2.0 * ground + top))
    place = math.sqrt(max(squared, 0.0))
    if air.layer_share > 0.0:
        reach = air.layer_reach_m
        in_layer = (1.0 - math.exp(-altitude / reach)) / (1.0 - math.exp(-top / reach))
        place += air.layer_share * (in_layer - place)
    return place


@inner
def altitude_at(air, place):  # type: ignore[no-untyped-def]
    """The altitude at a place, where there is a dense layer."""
    low, high = 0.0, air.top_altitude_m
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if altitude_place(air, middle) < place:
            low = middle
        else:
            high = middle
    return high


@fast
def layer_nodes(air, count):  # type: ignore[no-untyped-def]
    """Altitudes (count,) in m from the ground to the top, even in place, where there is a layer."""
    altitude = np.empty(count)
    for i in range(count):
        altitude[i] = altitude_at(air, i / (count - 1))
    altitude[0], altitude[-1] = 0.0, air.top_altitude_m
    return altitude

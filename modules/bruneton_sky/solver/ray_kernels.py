"""A ray through an exponential air, for compiled code: altitudes, lengths, densities.

The axis of altitudes of the solver's tables: in clear air places are uniform in sqrt(r^2 - Rg^2).
A dense layer, fog or haze, adds nodes uniform in 1 - exp(-altitude / layer_reach_m): the axis is a
blend of both, with layer_share of it for the layer. The total number of nodes grows: the clear air
keeps as many as it would have alone.

Importing this module imports numba.
"""

import math

import numpy as np

from bruneton_sky.path_kernels import layer_at
from bruneton_sky.solver.cell_kernels import fast, inner

# Bisections: 60 km over 2^50 is below a nanometre.
_HALVINGS = 50
# Rise in m below which a tent's density counts as even: the difference of columns loses digits.
_LEVEL_M = 1.0


def nodes_of_axis(count: int, layer_share: float) -> int:
    """Number of nodes of an axis that has `count` in clear air."""
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


@inner
def ray_length(air, altitude, mu, hits):  # type: ignore[no-untyped-def]
    """Distance in m to the ground if the ray `hits` it, else to the top of the atmosphere."""
    along = (air.ground_radius_m + altitude) * mu
    if hits:
        squares = altitude * (2.0 * air.ground_radius_m + altitude)
        return squares / max(-along + math.sqrt(max(along * along - squares, 0.0)), 1e-300)
    above = max(air.top_altitude_m - altitude, 0.0)
    squares = above * (2.0 * air.ground_radius_m + air.top_altitude_m + altitude)
    root = math.sqrt(along * along + squares)
    return squares / max(root + along, 1e-300) if along > 0.0 else root - along


@inner
def hits_ground(air, altitude, mu):  # type: ignore[no-untyped-def]
    """Whether a ray ends on the ground."""
    along = (air.ground_radius_m + altitude) * mu
    return mu < 0.0 and along * along >= altitude * (2.0 * air.ground_radius_m + altitude)


@inner
def altitude_along(radius, altitude, mu, distance):  # type: ignore[no-untyped-def]
    """Altitude in m at a distance along a ray that starts at a radius, which is at an altitude."""
    step = distance * (distance + 2.0 * radius * mu)
    return altitude + step / (math.sqrt(max(step + radius * radius, 0.0)) + radius)


@inner
def mean_density(near, middle, far, scale):  # type: ignore[no-untyped-def]
    """Mean of exp(-altitude / scale) over a step, from altitudes at its ends and middle.

    The altitude rises by z scale heights from middle to end, and bends by `bend`: the mean is
    that of the middle times sinh(z) / z, less a sixth of the bend. A step over many scale heights
    is high up, where there is no matter.
    """
    z = min(0.5 * abs(far - near) / scale, 3.0)
    bend = (near + far - 2.0 * middle) / scale
    z2 = z * z
    rise = 1.0 + z2 / 6.0 * (1.0 + z2 / 20.0 * (1.0 + z2 / 42.0))
    return math.exp(-max(middle, 0.0) / scale) * rise / (1.0 + max(bend, 0.0) / 6.0)


@inner
def layer_density(near, middle, far, scale):  # type: ignore[no-untyped-def]
    """The same of a layer that there may not be: its scale height is 0 then."""
    return mean_density(near, middle, far, scale) if scale > 0.0 else 0.0


@inner
def molecules_density(air, near, middle, far):  # type: ignore[no-untyped-def]
    """The same of the molecules, by the scale height of the layer that the middle lies in."""
    layer = layer_at(air.molecules[0], middle)
    scale = air.molecules[2, layer]
    return air.molecules[1, layer] * mean_density(near, middle, far, scale)


@inner
def tent_density(air, near, middle, far):  # type: ignore[no-untyped-def]
    """The same of the stratosphere's aerosol; 0 without any."""
    if air.stratosphere.shape[1] < 2:
        return 0.0
    return 0.5 * (_tent_mean(air, near, middle) + _tent_mean(air, middle, far))


@inner
def _tent_mean(air, start, end):  # type: ignore[no-untyped-def]
    """Mean density of the tent between two altitudes: its column between them over the rise."""
    if abs(end - start) < _LEVEL_M:
        return tent_at(air, 0.5 * (start + end))
    return (_tent_column(air, end) - _tent_column(air, start)) / (end - start)


@inner
def _tent_column(air, altitude):  # type: ignore[no-untyped-def]
    """Column of the tent below an altitude, in m of the density 1."""
    peak, half_width = air.stratosphere[0, 1], air.stratosphere[0, 2] - air.stratosphere[0, 1]
    x = min(max((altitude - peak) / half_width, -1.0), 1.0)
    return half_width * (0.5 + x - 0.5 * x * abs(x))


@inner
def tent_at(air, altitude):  # type: ignore[no-untyped-def]
    """Density of the stratosphere's aerosol at an altitude; there must be some."""
    peak, half_width = air.stratosphere[0, 1], air.stratosphere[0, 2] - air.stratosphere[0, 1]
    return max(1.0 - abs(altitude - peak) / half_width, 0.0)


@inner
def absorber_density(air, altitude):  # type: ignore[no-untyped-def]
    """Relative density of the absorber, straight between the nodes of its layers."""
    nodes, density = air.absorber[0], air.absorber[1]
    for k in range(nodes.size - 1):
        if nodes[k] <= altitude < nodes[k + 1]:
            share = (altitude - nodes[k]) / (nodes[k + 1] - nodes[k])
            return density[k] + share * (density[k + 1] - density[k])
    return 0.0

"""The matter along a ray in a few bins, each as seen through the air before it.

Any integral of a source function J along a ray is the sum over bins of weight times J at the
bin's centre. The weights are sums over fine steps of transmittance times scattering, so that
the matter of a ray is kept exactly however few its bins. A step's mean transmittance is that of
an exponential, and its mean density that of an exponential of an altitude quadratic in the
distance.

Importing this module imports numba.
"""

import math
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.quadrature import FOG_TOP
from bruneton_sky.solver.cell_kernels import fast, inner, making
from bruneton_sky.solver.ray_kernels import (
    absorber_density,
    altitude_along,
    hits_ground,
    layer_density,
    mean_density,
    molecules_density,
    ray_length,
    tent_density,
)

# Columns of the scratch array of steps; the middle is the centre of the light.
_END, _MIDDLE, _MASS, _WEIGHT = 0, 1, 2, 3
STEP_COLUMNS = 11


class Bins(NamedTuple):
    """Bins of a ray, in order.

    `edge` (n + 1,): distances in m. `centre` (n, 4): distance, altitude (m) and cosine mu at the
    bin's centre of mass, and the mass, the sum of its weights. `weight` (n, 2, 4): scattering by
    molecules and aerosol as seen from the start, for four wavelengths. `end` (5,): transmittance
    of the ray, and its length.
    """

    edge: NDArray[np.float64]
    centre: NDArray[np.float64]
    weight: NDArray[np.float64]
    end: NDArray[np.float64]

    @classmethod
    def empty(cls, rays: tuple[int, ...], count: int) -> Self:
        """Arrays for `count` bins of each ray; the rays' axes come first."""
        return cls(
            np.empty((*rays, count + 1)),
            np.empty((*rays, count, 4)),
            np.empty((*rays, count, 2, 4)),
            np.empty((*rays, 5)),
        )


@making
def empty_bins(count):  # type: ignore[no-untyped-def]
    """Arrays for `count` bins."""
    return Bins(np.empty(count + 1), np.empty((count, 4)), np.empty((count, 2, 4)), np.empty(5))


@making
def empty_steps(air, count):  # type: ignore[no-untyped-def]
    """Arrays for `count` fine steps of a ray; twice as many where there is fog."""
    return np.empty((2 * count if air.fog_scale_height_m > 0.0 else count, STEP_COLUMNS))


@inner
def fill_bins(air, altitude, mu, hits, steps, bins):  # type: ignore[no-untyped-def]
    """Bin the ray from an altitude along mu; `steps` (n, STEP_COLUMNS) is scratch.

    `hits`: whether the ray ends on the ground.
    """
    fill_steps(air, altitude, mu, hits, steps, bins.end)
    merge_steps(air, altitude, mu, steps, bins)


@fast
def bins_of_ray(air, altitude, mu, sizes):  # type: ignore[no-untyped-def]
    """The bins of one ray; `sizes`: steps, bins."""
    bins = empty_bins(sizes[1])
    steps = empty_steps(air, sizes[0])
    fill_bins(air, altitude, mu, hits_ground(air, altitude, mu), steps, bins)
    return bins


@inner
def merge_steps(air, altitude, mu, steps, bins):  # type: ignore[no-untyped-def]
    """Merge the steps of a ray, which `fill_steps` made, into its bins.

    The bins have equal shares of the sum of two measures, each normalised: the light the bin
    scatters, and its length. By length alone the near air would be coarse, by light alone the
    far air, which is what shines in twilight.
    """
    count = bins.centre.shape[0]
    mass = 0.0
    for s in range(steps.shape[0]):
        mass += steps[s, _MASS]
    bins.centre[:] = 0.0
    bins.weight[:] = 0.0
    bins.edge[:] = 0.0
    share, start = 0.0, 0.0
    per_mass = 0.5 / mass if mass > 0.0 else 0.0
    per_metre = (0.5 if mass > 0.0 else 1.0) / max(steps[-1, _END], 1e-300)
    for s in range(steps.shape[0]):
        step = steps[s]
        part = step[_MASS] * per_mass + (step[_END] - start) * per_metre
        b = min(int((share + 0.5 * part) * count), count - 1)
        share += part
        start = step[_END]
        bins.edge[b + 1] = step[_END]
        bins.centre[b, 0] += step[_MASS] * step[_MIDDLE]
        bins.centre[b, 3] += step[_MASS]
        for c in range(4):
            bins.weight[b, 0, c] += step[_WEIGHT + c]
            bins.weight[b, 1, c] += step[_WEIGHT + 4 + c]
    _place_centres(air, altitude, mu, bins)


@inner
def _place_centres(air, altitude, mu, bins):  # type: ignore[no-untyped-def]
    radius = air.ground_radius_m + altitude
    for b in range(bins.centre.shape[0]):
        # A bin that no step fell into has no length.
        bins.edge[b + 1] = max(bins.edge[b + 1], bins.edge[b])
        if bins.centre[b, 3] > 0.0:
            distance = bins.centre[b, 0] / bins.centre[b, 3]
        else:
            distance = 0.5 * (bins.edge[b] + bins.edge[b + 1])
        there = altitude_along(radius, altitude, mu, distance)
        there = min(max(there, 0.0), air.top_altitude_m)
        bins.centre[b, 0], bins.centre[b, 1] = distance, there
        cosine = (radius * mu + distance) / (air.ground_radius_m + there)
        bins.centre[b, 2] = min(max(cosine, -1.0), 1.0)


@inner
def fill_steps(air, altitude, mu, hits, steps, end):  # type: ignore[no-untyped-def]
    """Fine steps of a ray: distances of end and middle, mass, eight weights."""
    if air.fog_scale_height_m > 0.0:
        _fill_steps_in_fog(air, altitude, mu, hits, steps, end)
    else:
        _fill_steps_in_clear_air(air, altitude, mu, hits, steps, end)


@inner
def _fill_steps_in_clear_air(air, altitude, mu, hits, steps, end):  # type: ignore[no-untyped-def]
    count = steps.shape[0]
    radius = air.ground_radius_m + altitude
    length = ray_length(air, altitude, mu, hits)
    dense, before = _dense_place(radius * mu, length, hits, count)
    end[0], end[1], end[2], end[3], end[4] = 1.0, 1.0, 1.0, 1.0, length
    distance, near = 0.0, altitude
    for s in range(count):
        if s < before:
            x = 1.0 - (s + 1) / before
            stop = dense * (1.0 - x * x)
        else:
            x = (s - before + 1) / (count - before)
            stop = dense + (length - dense) * x * x
        metres = stop - distance
        middle = altitude_along(radius, altitude, mu, distance + 0.5 * metres)
        far = altitude_along(radius, altitude, mu, stop)
        step = steps[s]
        step[_END] = stop
        molecules = metres * molecules_density(air, near, middle, far)
        aerosol = metres * mean_density(near, middle, far, air.mie_scale_height_m)
        aloft = metres * layer_density(near, middle, far, air.aloft_scale_height_m)
        high = metres * tent_density(air, near, middle, far)
        absorber = metres * absorber_density(air, middle)
        centre = _weigh_step(air, molecules, aerosol, aloft, high, absorber, end, step)
        step[_MIDDLE] = distance + centre * metres
        distance, near = stop, far


@inner
def _weigh_step(air, molecules, aerosol, aloft, high, absorber, light, step):  # type: ignore[no-untyped-def]
    """Weights of a step whose matter is given in m, and what light is left after it.

    Returns where in the step, from 0 to 1, the centre of its light lies.
    """
    mass, moment = 0.0, 0.0
    for c in range(4):
        depth = air.extinction[0, c] * molecules + air.extinction[1, c] * aerosol
        depth += air.extinction[2, c] * absorber + air.extinction[4, c] * aloft
        depth += air.extinction[5, c] * high
        haze = air.scattering[1, c] * aerosol + air.scattering[2, c] * aloft
        haze += air.scattering[4, c] * high
        passed = math.exp(-depth)
        mean = (1.0 - passed) / depth if depth > 1e-5 else 1.0 - 0.5 * depth
        step[_WEIGHT + c] = light[c] * mean * air.scattering[0, c] * molecules
        step[_WEIGHT + 4 + c] = light[c] * mean * haze
        part = step[_WEIGHT + c] + step[_WEIGHT + 4 + c]
        mass += part
        moment += part * _centre(depth, passed)
        light[c] *= passed
    step[_MASS] = mass
    return moment / mass if mass > 0.0 else 0.5


@inner
def _centre(depth, passed):  # type: ignore[no-untyped-def]
    """Mean place in [0, 1] of light scattered evenly over a depth, of which `passed` is left."""
    return 1.0 / depth - passed / (1.0 - passed) if depth > 1e-2 else 0.5 - depth / 12.0


@inner
def _dense_place(along, length, hits, count):  # type: ignore[no-untyped-def]
    """Where on a ray the air is densest, and how many of the steps come before it.

    Steps shrink quadratically toward that place, from both sides to the same size.
    """
    if hits:
        return length, count
    if along >= 0.0:
        return 0.0, 0
    dense = min(-along, length)
    near, far = math.sqrt(dense), math.sqrt(length - dense)
    before = min(int(count * near / max(near + far, 1e-300) + 0.5), count - 1)
    return (dense, before) if before > 0 else (0.0, 0)


@inner
def _fill_steps_in_fog(air, altitude, mu, hits, steps, end):  # type: ignore[no-untyped-def]
    """The steps of `_fill_steps_in_clear_air` in air with fog: half of them lie in the fog.

    A separate function, so that clear air pays nothing for fog.
    """
    count = steps.shape[0]
    radius = air.ground_radius_m + altitude
    length = ray_length(air, altitude, mu, hits)
    dense, before = _dense_place(radius * mu, length, hits, count)
    foggy = _length_in_fog(air, altitude, radius * mu, hits)
    end[0], end[1], end[2], end[3], end[4] = 1.0, 1.0, 1.0, 1.0, length
    distance, near = 0.0, altitude
    for s in range(count):
        if s < before:
            stop = dense - _spread(1.0 - (s + 1) / before, dense, foggy)
        else:
            stop = dense + _spread((s - before + 1) / (count - before), length - dense, foggy)
        metres = stop - distance
        middle = altitude_along(radius, altitude, mu, distance + 0.5 * metres)
        far = altitude_along(radius, altitude, mu, stop)
        step = steps[s]
        step[_END] = stop
        molecules = metres * molecules_density(air, near, middle, far)
        aerosol = metres * mean_density(near, middle, far, air.mie_scale_height_m)
        aloft = metres * layer_density(near, middle, far, air.aloft_scale_height_m)
        fog = metres * mean_density(near, middle, far, air.fog_scale_height_m)
        high = metres * tent_density(air, near, middle, far)
        absorber = metres * absorber_density(air, middle)
        centre = _weigh_step_in_fog(air, molecules, aerosol, aloft, fog, high, absorber, end, step)
        step[_MIDDLE] = distance + centre * metres
        distance, near = stop, far


@inner
def _weigh_step_in_fog(air, molecules, aerosol, aloft, fog, high, absorber, light, step):  # type: ignore[no-untyped-def]
    """`_weigh_step` with fog."""
    mass, moment = 0.0, 0.0
    for c in range(4):
        depth = air.extinction[0, c] * molecules + air.extinction[1, c] * aerosol
        depth += air.extinction[2, c] * absorber + air.extinction[3, c] * fog
        depth += air.extinction[4, c] * aloft + air.extinction[5, c] * high
        passed = math.exp(-depth)
        mean = (1.0 - passed) / depth if depth > 1e-5 else 1.0 - 0.5 * depth
        haze = air.scattering[1, c] * aerosol + air.scattering[2, c] * aloft
        haze += air.scattering[3, c] * fog + air.scattering[4, c] * high
        step[_WEIGHT + c] = light[c] * mean * air.scattering[0, c] * molecules
        step[_WEIGHT + 4 + c] = light[c] * mean * haze
        part = step[_WEIGHT + c] + step[_WEIGHT + 4 + c]
        mass += part
        moment += part * _centre(depth, passed)
        light[c] *= passed
    step[_MASS] = mass
    return moment / mass if mass > 0.0 else 0.5


@inner
def _length_in_fog(air, altitude, along, hits):  # type: ignore[no-untyped-def]
    """Length in m of a ray in fog from its densest place, the same on either side."""
    double = 2.0 * air.ground_radius_m + altitude
    top = FOG_TOP * air.fog_scale_height_m
    # Squared distances from the perigee to an altitude, on the ray's line.
    to_top = along * along + (top - altitude) * (double + top)
    densest = max(along, 0.0) ** 2
    if hits:
        densest = along * along - altitude * double
    return max(math.sqrt(max(to_top, 0.0)) - math.sqrt(max(densest, 0.0)), 0.0)


@inner
def _spread(x, whole, foggy):  # type: ignore[no-untyped-def]
    """Distance from the densest place at x in [0, 1]: the first half of it lies in fog.

    In both halves steps shrink quadratically toward that place.
    """
    if foggy >= whole:
        return whole * x * x
    if x < 0.5:
        return foggy * 4.0 * x * x
    return foggy + (whole - foggy) * (2.0 * x - 1.0) ** 2

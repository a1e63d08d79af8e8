"""Refracted paths through the air: metres of ground density along the line of sight to space.

Along a ray n r sin(psi) is constant (Bouguer's law; psi is its angle to the vertical), so that a
path through the density rho is the integral of rho dh / cos(psi) over the altitude h. From where a
ray is level, cos(psi) grows as the root of the height: with h = start + u^2 times the rest the
integrand is smooth in u, and Gauss-Legendre between the densities' kinks converges fast.

Differences of n r are taken as those of altitude and refractivity, not of radii: a ray that is
level on the ground keeps all digits.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.numeric_types import FloatArray

Density = Callable[[FloatArray], FloatArray]

_X, _W = np.polynomial.legendre.leggauss(24)
_BISECTIONS = 60
_TINY = 1e-300
# Least growth of n r with the altitude: `BentAir.limited` leaves twice as much.
_LEAST_GROWTH, _MOST_BENT = 0.1, 0.8


class BentAir(NamedTuple):
    """Air that bends rays.

    Attributes:
        ground_radius_m, top_altitude_m: rays are straight above the top.
        refractivity: n - 1 where `density` is 1; 0 leaves rays straight.
        density: of the bending gas, relative, of altitudes in m.
        kinks_m: altitudes where a density that is asked for has a kink, rising.
    """

    ground_radius_m: float
    top_altitude_m: float
    refractivity: float
    density: Density
    kinks_m: tuple[float, ...] = ()

    def limited(self, steepest_per_m: float) -> "BentAir":
        """The air with so little refraction that level rays leave the ground.

        Dense air on a great planet would bend them round it. `steepest_per_m` is the fastest fall
        of the density.
        """
        most = _MOST_BENT / max(self.ground_radius_m * steepest_per_m, _TINY)
        return self._replace(refractivity=min(self.refractivity, most))


def exponential(scale_height_m: float, altitude_m: FloatArray) -> FloatArray:
    """Relative density (...,) of a layer that thins by a factor e over a height."""
    return np.asarray(np.exp(-altitude_m / scale_height_m))


def tent(half_width_m: float, peak_m: float, altitude_m: FloatArray) -> FloatArray:
    """Relative density (...,) that falls linearly from 1 at a peak to 0 on both sides."""
    return np.maximum(1.0 - np.abs(altitude_m - peak_m) / half_width_m, 0.0)


def slant_paths(
    air: BentAir, altitude_m: ArrayLike, sine: ArrayLike, densities: Sequence[Density]
) -> FloatArray:
    """Paths (..., densities) in m of density 1, from an observer to the top of the air.

    Against 30 times as many nodes they err by less than 1e-6, for scale heights from 100 m up.

    Args:
        altitude_m: (...,) of the observer over the ground, 0 or more; may lie above the air.
        sine: (...,) of the apparent elevation there. A ray that would meet the ground grazes it.
        densities: relative densities at altitudes (...,) in m.
    """
    altitude, rise = np.broadcast_arrays(
        np.asarray(altitude_m, dtype=float), np.asarray(sine, dtype=float)
    )
    shape = altitude.shape
    altitude, rise, misses = _entry(air, altitude.ravel(), rise.ravel())
    excess = _excess(air, altitude, rise)
    # Where the ray starts to climb, its own n r exceeds the invariant by this much.
    level = np.where(rise >= 0.0, excess, 0.0)
    lowest = altitude.copy()
    descends = (rise < 0.0) & (altitude > 0.0)
    if descends.any():
        lowest[descends] = _perigee(air, altitude[descends], excess[descends])
    paths = _climb(air, lowest, level, np.full(lowest.size, air.top_altitude_m), densities)
    if descends.any():
        paths += _climb(air, lowest, level, altitude, densities)
    return np.where(misses[:, None], 0.0, paths).reshape(*shape, len(densities))


def horizon_sine(air: BentAir, altitude_m: ArrayLike) -> FloatArray:
    """Sine (...,) of the apparent elevation of the ground's horizon, 0 or less."""
    altitude = np.asarray(altitude_m, dtype=float)
    within = np.minimum(altitude, air.top_altitude_m)
    here = air.ground_radius_m + within
    lost = _risen(air, np.zeros_like(within), within)
    # Over the top rays are straight: r sin(psi) stays what it was there.
    lost = lost + (altitude - within)
    here = (1.0 + air.refractivity * air.density(within)) * here + (altitude - within)
    share = lost / here
    return np.asarray(-np.sqrt(np.maximum(share * (2.0 - share), 0.0)))


def _entry(
    air: BentAir, altitude: FloatArray, sine: FloatArray
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Altitude and sine where rays from above the air enter it, and whether they miss it."""
    above = altitude > air.top_altitude_m
    top = air.ground_radius_m + air.top_altitude_m
    perigee = (air.ground_radius_m + altitude) * np.sqrt(np.maximum((1.0 - sine) * (1.0 + sine), 0))
    squares = (top - perigee) * (top + perigee)
    misses = above & ((sine >= 0.0) | (squares <= 0.0))
    entering = np.where(misses, 0.0, -np.sqrt(np.maximum(squares, 0.0)) / top)
    return np.minimum(altitude, air.top_altitude_m), np.where(above, entering, sine), misses


def _excess(air: BentAir, altitude: FloatArray, sine: FloatArray) -> FloatArray:
    """n r less the ray's invariant n r cos(elevation) (...,) at the observer, in m; a ray that
    would meet the ground gets the invariant of the one that grazes it."""
    here = (1.0 + air.refractivity * air.density(altitude)) * (air.ground_radius_m + altitude)
    cosine = np.sqrt(np.maximum((1.0 - sine) * (1.0 + sine), 0.0))
    excess = here * sine * sine / (1.0 + cosine)
    return np.where(sine < 0.0, np.minimum(excess, _risen(air, 0.0 * altitude, altitude)), excess)


def _risen(air: BentAir, low: FloatArray, high: FloatArray) -> FloatArray:
    """n r at an altitude less n r at a lower one, (...,) in m."""
    there, here = air.density(high), air.density(low)
    rise = (high - low) * (1.0 + air.refractivity * there)
    return np.asarray(rise + air.refractivity * (there - here) * (air.ground_radius_m + low))


def _perigee(air: BentAir, altitude: FloatArray, excess: FloatArray) -> FloatArray:
    """Altitudes (n,) where descending rays are level: n r grows with the altitude."""
    low, high = np.zeros_like(altitude), altitude
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        deep = _risen(air, middle, altitude) > excess
        low, high = np.where(deep, middle, low), np.where(deep, high, middle)
    return 0.5 * (low + high)


def _climb(
    air: BentAir,
    start: FloatArray,
    excess: FloatArray,
    end: FloatArray,
    densities: Sequence[Density],
) -> FloatArray:
    """Paths (n, densities) of climbing rays whose n r exceeds their invariant by `excess`."""
    whole = np.maximum(end - start, _TINY)
    edges = np.clip([start, *(np.full(start.size, kink) for kink in air.kinks_m), end], start, end)
    place = np.sqrt((edges - start) / whole)
    half = 0.5 * np.diff(place, axis=0)[..., None]
    u = place[:-1, :, None] + half * (1.0 + _X)
    climbed = whole[:, None] * u * u
    altitude = start[:, None] + climbed
    over = excess[:, None] + _risen(air, np.broadcast_to(start[:, None], altitude.shape), altitude)
    # Within a nanometre of the level the densities' difference is rounding.
    over = np.maximum(over, _LEAST_GROWTH * climbed)
    here = (1.0 + air.refractivity * air.density(altitude)) * (air.ground_radius_m + altitude)
    cosine = np.sqrt(np.maximum(over * (2.0 * here - over), _TINY)) / here
    step = half * _W * 2.0 * whole[:, None] * u / cosine
    return np.stack([(step * density(altitude)).sum(axis=(0, 2)) for density in densities], axis=-1)

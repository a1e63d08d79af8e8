"""The solver's grid: altitudes, directions of views, zenith angles of the sun.

Altitudes are uniform in sqrt(r^2 - Rg^2), so dense near the ground; directions are dense toward
the horizon, and so are suns.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import horizon_mu
from vrut_lite.numeric_types import FloatArray

# Where the axis of suns is densest, as sqrt(1 - mu_s), and over what width; in air for suns lower
# than 12.5 degrees down it is lower and wider.
_CENTRE, _WIDTH = 1.034, 0.12
_NIGHT_CENTRE, _NIGHT_WIDTH = 1.06, 0.25
_NIGHT_MU_S = -0.2164


def altitude_nodes(atmosphere: Atmosphere, count: int) -> FloatArray:
    """Altitudes (count,) in m from the ground to the top, uniform in sqrt(r^2 - Rg^2)."""
    radius, top = atmosphere.ground_radius_m, atmosphere.top_altitude_m
    squared = top * (2.0 * radius + top) * np.linspace(0.0, 1.0, count) ** 2
    altitude = squared / (np.sqrt(squared + radius * radius) + radius)
    altitude[-1] = top
    return altitude


def lowest_mu_s(atmosphere: Atmosphere) -> float:
    """Cosine of the lowest sun that air within sight can have.

    An observer with the sun at mu_s_min sees air as far away as the dip of the horizon from
    the top of the atmosphere; there the sun is so much lower.
    """
    radius = atmosphere.ground_radius_m
    dip = np.arccos(radius / (radius + atmosphere.top_altitude_m))
    return float(np.cos(min(np.arccos(atmosphere.mu_s_min) + dip, np.pi)))


def reaches_night(atmosphere: Atmosphere) -> bool:
    """Whether the air is for suns lower than 12.5 degrees down."""
    return atmosphere.mu_s_min < _NIGHT_MU_S


class SunGrid:
    """Nodes of mu_s, and the numbers with which kernels find a place among them.

    c = sqrt(1 - mu_s) is nearly the sun's zenith angle over sqrt(2). Nodes are densest about
    c = `centre`, a sun 4 degrees down, whose light falls by a factor with every degree; away from
    there they spread as d / (`width` + |d|) of d = c - `centre`. For suns to 18.5 degrees down the
    centre is 7 degrees down. Towards the zenith they must not
    spread too far: haze has a bright lobe around the sun, which moves from node to node.
    With 48 nodes they stand 1 degree apart at the horizon, 3.5 at 50 degrees, 7 at the zenith.
    """

    def __init__(self, atmosphere: Atmosphere, count: int) -> None:
        deep = reaches_night(atmosphere)
        self.centre = _NIGHT_CENTRE if deep else _CENTRE
        self.width = _NIGHT_WIDTH if deep else _WIDTH
        self.lowest = float(self._spread(lowest_mu_s(atmosphere)))
        self.extent = self.lowest - float(self._spread(1.0))
        self.mu_s = self.mu_s_at(np.linspace(0.0, 1.0, count))

    def place(self, mu_s: ArrayLike) -> FloatArray:
        """Place (...,) in [0, 1], 1 in the zenith."""
        return np.clip((self.lowest - self._spread(mu_s)) / self.extent, 0.0, 1.0)

    def mu_s_at(self, place: ArrayLike) -> FloatArray:
        """The cosine (...,) at a place."""
        g = self.lowest - np.asarray(place, dtype=float) * self.extent
        c = self.width * g / (1.0 - np.abs(g)) + self.centre
        return np.clip(1.0 - c * c, -1.0, 1.0)

    def constants(self) -> NDArray[np.float32]:
        """Constants of the grid for `later_order_kernels.sun_place`."""
        numbers = self.centre, self.width, self.lowest, 1.0 / self.extent
        return np.array(numbers, dtype=np.float32)

    def _spread(self, mu_s: ArrayLike) -> FloatArray:
        d = np.sqrt(1.0 - np.asarray(mu_s, dtype=float)) - self.centre
        return np.asarray(d / (self.width + np.abs(d)))


class Directions(NamedTuple):
    """Zenith cosines `mu` at each altitude and their weights, (altitudes, n) both.

    Those below the horizon, `downward` (n,), come first.
    """

    mu: FloatArray
    weight: FloatArray
    downward: NDArray[np.bool_]


def make_directions(ground_radius_m: float, altitude_m: FloatArray, count: int) -> Directions:
    """Gauss-Legendre on either side of each altitude's horizon, clustered toward it.

    Radiance jumps at the horizon and is brightest there: with x the nodes on [0, 1],
    mu = mu_horizon +- (1 -+ mu_horizon) x^2.
    """
    x, w = clustered_nodes(count // 2)
    horizon = horizon_mu(ground_radius_m, altitude_m)[:, None]
    mu = np.concatenate([horizon - (1.0 + horizon) * x, horizon + (1.0 - horizon) * x], axis=1)
    weight = np.concatenate([(1.0 + horizon) * w, (1.0 - horizon) * w], axis=1)
    return Directions(mu, weight, np.arange(count) < count // 2)


def clustered_nodes(count: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights (count,) on [0, 1], dense toward 0: Gauss-Legendre in the root."""
    x, w = np.polynomial.legendre.leggauss(count)
    root = 0.5 * (x + 1.0)
    return root * root, root * w


def azimuths(count: int) -> FloatArray:
    """Midpoints (count,) of equal parts of half a turn; the other half is its mirror image."""
    return (np.arange(count) + 0.5) * np.pi / count

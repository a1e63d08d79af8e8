"""Directions over which light is gathered at a node, with their quadrature weights."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.geometry import horizon_mu
from vrut_lite.numeric_types import FloatArray


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
    """Midpoints (count,) of equal parts of half a turn: the sun's plane mirrors the rest."""
    return (np.arange(count) + 0.5) * np.pi / count

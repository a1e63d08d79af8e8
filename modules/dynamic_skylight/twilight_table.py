"""The distribution of twilight over the sky: a table of solved multiple scattering.

The table (`data/twilight.npz`, made by vrut_lite_lab.twilight_fit) holds the logarithm of the sky's
radiance over the illuminance on level ground, for seven turbidities from 1 to 10, suns from 2 to
-13 deg and a grid of directions. For one hour it is interpolated to a map of 64 x 32 directions
for bilinear look-up, small enough to be a shader's texture.

Directions have the coordinates v and a, both in [0, 1]:

* v = sqrt(1 - sqrt(1 - z)) with z the sine of the elevation: steps are fine at the horizon, where
  the sky changes fastest, and uniform in angle at the zenith.
* a = sin(azimuth / 2), the azimuth from the sun's: a sky that is symmetric about the sun's plane is
  smooth in a at both ends.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamic_skylight.data_files import packaged_arrays
from vrut_lite.geometry.colour import LUMINANCE_WEIGHTS
from vrut_lite.numeric_types import FloatArray

MAP_SHAPE = (64, 32)
_QUADRATURE = 512


@dataclass(frozen=True)
class TwilightTable:
    """The solved skies.

    Attributes:
        log_shape: ln of radiance over illuminance (T, S, V, A, 3), illuminance as CIE Y.
        turbidity: (T,), rising.
        first_sun_deg, sun_step_deg: elevations of the S suns, in uniform steps downwards.
    """

    log_shape: FloatArray
    turbidity: FloatArray
    first_sun_deg: float
    sun_step_deg: float

    def directions(self, turbidity: float, sun_deg: float) -> FloatArray:
        """Radiance per luminous irradiance (64, 32, 3) on the map's v and a, in sr^-1.

        The logarithm is linear in the logarithm of turbidity. Beyond the table's turbidities and
        suns, the values at its ends hold.
        """
        suns = self.log_shape.shape[1]
        position = (self.first_sun_deg - sun_deg) / self.sun_step_deg
        of_sun = cubic_weights(np.array([position]), suns)[0]
        of_haze = self._haze_weights(turbidity)
        t, s = np.flatnonzero(of_haze), np.flatnonzero(of_sun)
        some = self.log_shape[t[0] : t[-1] + 1, s[0] : s[-1] + 1]
        weights = of_haze[t[0] : t[-1] + 1], of_sun[s[0] : s[-1] + 1]
        logarithm = np.einsum("t,s,tsvac->vac", *weights, some, optimize=True)
        fine_v = _refining(logarithm.shape[0], MAP_SHAPE[0])
        fine_a = _refining(logarithm.shape[1], MAP_SHAPE[1])
        shape = np.exp(np.einsum("iv,ja,vac->ijc", fine_v, fine_a, logarithm, optimize=True))
        return shape / luminous_irradiance(shape)

    def _haze_weights(self, turbidity: float) -> FloatArray:
        """Weights (T,) of the table's turbidities."""
        place = np.interp(np.log(turbidity), np.log(self.turbidity), np.arange(self.turbidity.size))
        i = min(int(place), self.turbidity.size - 2)
        weights = np.zeros(self.turbidity.size)
        weights[i : i + 2] = i + 1.0 - place, place - i
        return weights


@lru_cache(maxsize=1)
def twilight_table() -> TwilightTable:
    """The packaged table."""
    data = packaged_arrays("twilight.npz")
    sun = data["sun_deg"]
    return TwilightTable(
        data["log_shape_steps"] * float(data["log_step"]),
        data["turbidity"],
        float(sun[0]),
        float(sun[0] - sun[1]),
    )


def elevation_coordinate(sin_elevation: ArrayLike) -> FloatArray:
    """v (...,) of the sine of an elevation, without cancellation at the horizon."""
    z = np.clip(np.asarray(sin_elevation, dtype=float), 0.0, 1.0)
    return np.asarray(np.sqrt(z / (1.0 + np.sqrt(1.0 - z))))


def sin_elevation_of(v: ArrayLike) -> FloatArray:
    """Inverse of `elevation_coordinate`."""
    square = np.asarray(v, dtype=float) ** 2
    return np.asarray(square * (2.0 - square))


def azimuth_coordinate(cos_azimuth: ArrayLike) -> FloatArray:
    """a (...,) of the cosine of the azimuth from the sun's."""
    cosine = np.clip(np.asarray(cos_azimuth, dtype=float), -1.0, 1.0)
    return np.asarray(np.sqrt(0.5 - 0.5 * cosine))


def look_up(directions: FloatArray, v: ArrayLike, a: ArrayLike) -> FloatArray:
    """A map (V, A, 3) at coordinates (...,) in [0, 1], bilinear: (..., 3)."""
    rows, columns = directions.shape[:2]
    row, i = _cell(np.asarray(v, dtype=float), rows)
    column, j = _cell(np.asarray(a, dtype=float), columns)
    row, column = row[..., None], column[..., None]
    near = directions[i, j] * (1 - column) + directions[i, j + 1] * column
    far = directions[i + 1, j] * (1 - column) + directions[i + 1, j + 1] * column
    return np.asarray(near * (1 - row) + far * row)


def luminous_irradiance(directions: FloatArray) -> float:
    """CIE Y of the irradiance on level ground under a map (V, A, 3)."""
    weights = _irradiance_weights(*directions.shape[:2])
    return float(np.einsum("va,vac,c->", weights, directions, LUMINANCE_WEIGHTS))


def cubic_weights(position: FloatArray, count: int) -> FloatArray:
    """Weights (n, count) of evenly spaced nodes at positions (n,), in units of nodes.

    Catmull and Rom 1974: interpolates the nodes, has a continuous derivative, reproduces linear
    functions; beyond the ends the end values hold.
    """
    x = np.clip(position, 0.0, count - 1.0)
    i = np.minimum(x.astype(int), count - 2)
    t = x - i
    weights = [
        -0.5 * t + t**2 - 0.5 * t**3,
        1.0 - 2.5 * t**2 + 1.5 * t**3,
        0.5 * t + 2.0 * t**2 - 1.5 * t**3,
        -0.5 * t**2 + 0.5 * t**3,
    ]
    # One more node on either side, extrapolated linearly from the two next to it.
    padded = np.zeros((x.size, count + 2))
    for offset, weight in enumerate(weights):
        padded[np.arange(x.size), i + offset] += weight
    inner = padded[:, 1:-1].copy()
    inner[:, 0] += 2.0 * padded[:, 0]
    inner[:, 1] -= padded[:, 0]
    inner[:, -1] += 2.0 * padded[:, -1]
    inner[:, -2] -= padded[:, -1]
    return inner


def _cell(x: FloatArray, count: int) -> tuple[FloatArray, NDArray[np.intp]]:
    """The position (...,) of a coordinate within its cell, and the cell's first node."""
    scaled = x * (count - 1)
    i = np.clip(scaled.astype(np.intp), 0, count - 2)
    return scaled - i, i


@lru_cache(maxsize=4)
def _refining(count: int, fine: int) -> FloatArray:
    """Matrix (fine, count) that interpolates nodes to finer nodes with the same ends."""
    return cubic_weights(np.linspace(0.0, count - 1.0, fine), count)


@lru_cache(maxsize=2)
def _irradiance_weights(rows: int, columns: int) -> FloatArray:
    """Weight (V, A) of each node of a bilinear map in the irradiance of level ground, in sr.

    The integral of z dz over v, with dz = 4 v (1 - v^2) dv, and of azimuth over a, both by the
    midpoint rule, for a sky that is symmetric about the sun's plane.
    """
    middle = (np.arange(_QUADRATURE) + 0.5) / _QUADRATURE
    edges = sin_elevation_of(np.arange(_QUADRATURE + 1) / _QUADRATURE)
    ring = np.array([0.5 * (high**2 - low**2) for low, high in pairwise(edges)])
    azimuth = np.pi * middle
    of_v = _spread(middle, ring, rows)
    of_a = _spread(np.sin(0.5 * azimuth), np.full(_QUADRATURE, 2.0 * np.pi / _QUADRATURE), columns)
    return of_v[:, None] * of_a


def _spread(x: FloatArray, weight: FloatArray, count: int) -> FloatArray:
    """Distribute weights at coordinates (n,) to the nodes (count,) of a linear interpolation."""
    part, i = _cell(x, count)
    out = np.zeros(count)
    np.add.at(out, i, weight * (1.0 - part))
    np.add.at(out, i + 1, weight * part)
    return out

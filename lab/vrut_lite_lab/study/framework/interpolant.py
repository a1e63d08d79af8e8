"""A smooth function on the hemisphere through the values in the 81 directions.

Catmull-Rom's cubic along each ring of directions, and across the rings; at the zenith, rings
go on through it by a gradient taken from the innermost ring, and below the outermost ring the
last second difference stays. After Bruneton 2016 (the "spherical bicubic interpolation").
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.directions import RINGS, SIDE, ring_order

# Three rings beyond the outermost one, 12 deg above the horizon, as sums of the last three:
# each continues the second difference of those before it.
_BEYOND = np.array([[1.0, -3.0, 3.0], [3.0, -8.0, 6.0]])


def interpolate(values: ArrayLike, zenith_rad: ArrayLike, azimuth_rad: ArrayLike) -> FloatArray:
    """Values (81, *V) in the `directions`, at zenith angles and azimuths (*Q): (*Q, *V).

    Exact in the directions themselves; continuous, with its first derivatives, between them.
    The zenith angle is between 0 and pi/2.
    """
    known = np.asarray(values, dtype=float)
    zenith, azimuth = np.broadcast_arrays(
        np.asarray(zenith_rad, dtype=float), np.asarray(azimuth_rad, dtype=float)
    )
    flat = known.reshape(known.shape[0], -1)
    result = _at_points(flat, zenith.ravel(), azimuth.ravel())
    return result.reshape(zenith.shape + known.shape[1:])


def _at_points(values: FloatArray, zenith: FloatArray, azimuth: FloatArray) -> FloatArray:
    ring_weight = _ring_weights(zenith)
    rings = [values[members] for members in ring_order()]
    through = _around(rings[1], azimuth) - 2.0 * _slope_at_zenith(rings[1], azimuth)
    result = ring_weight[0][:, None] * through
    for weight, ring in zip(ring_weight[1:], rings, strict=True):
        used = np.flatnonzero(weight)
        result[used] += weight[used, None] * _around(ring, azimuth[used])
    return result


def _ring_weights(zenith: FloatArray) -> FloatArray:
    """How much (6, n) of the rings -1 to 4 is in each value."""
    # 1 - cos loses half of its digits at the zenith; the half angle's sine does not.
    position = np.sqrt(2.0) * np.sin(0.5 * zenith) * (SIDE / 2.0)
    low = np.floor(position).astype(int)
    weight = np.zeros((RINGS + 4, zenith.size))
    points = np.arange(zenith.size)
    for offset, part in enumerate(_catmull_rom(position - low)):
        weight[low + offset, points] = part
    beyond = _BEYOND[0][:, None] * weight[RINGS + 1] + _BEYOND[1][:, None] * weight[RINGS + 2]
    kept = weight[: RINGS + 1]
    kept[-3:] += beyond
    return kept


def _around(ring: FloatArray, azimuth: FloatArray) -> FloatArray:
    """Values (n, V) at azimuths (n,) of one ring's values (m, V), equally spaced from north."""
    position = azimuth * (len(ring) / (2.0 * np.pi))
    low = np.floor(position).astype(int)
    weights = _catmull_rom(position - low)
    parts = (w[:, None] * ring[(low + k - 1) % len(ring)] for k, w in enumerate(weights))
    return np.asarray(sum(parts))


def _slope_at_zenith(ring: FloatArray, azimuth: FloatArray) -> FloatArray:
    """Rise (n, V) from the zenith by one ring toward azimuths (n,), estimated from ring 1.

    0.83 of the slope of the least squares plane through its eight values, as published.
    """
    north, east = np.cos(np.pi / 4 * np.arange(8)), np.sin(np.pi / 4 * np.arange(8))
    scale = 0.5 / (1.0 + np.sqrt(2.0))
    toward = np.cos(azimuth)[:, None] * (north @ ring) + np.sin(azimuth)[:, None] * (east @ ring)
    return np.asarray(scale * toward)


def _catmull_rom(u: FloatArray) -> FloatArray:
    """Weights (4, n) of the values before, at, after and two after the place u in [0, 1)."""
    return 0.5 * np.stack(
        [
            u * (-1.0 + u * (2.0 - u)),
            2.0 + u * u * (-5.0 + 3.0 * u),
            u * (1.0 + u * (4.0 - 3.0 * u)),
            u * u * (u - 1.0),
        ]
    )

"""Linear polarisation of light: the axes of Q and U in a sky map, and reflection by dielectrics.

Q > 0 is light that vibrates along an axis across the ray, U > 0 light that vibrates 45 degrees
counter-clockwise from it, as an observer sees it who looks against the light. Directions point from
the observer to where the light comes from.

A sky map has one axis for each direction: +X at the zenith, carried along the great circle to the
direction. It is smooth everywhere but in the nadir; the vertical plane is not smooth in the zenith,
nor the plane of the sun at the sun, where a low sun's sky vibrates vertically.
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray

_UP = np.array([0.0, 1.0, 0.0])


def map_axis(direction: ArrayLike) -> FloatArray:
    """Axis (..., 3) of Q in a sky map at unit directions (..., 3) in world axes."""
    d = np.asarray(direction, dtype=float)
    share = d[..., :1] / (1.0 + np.maximum(d[..., 1:2], -1.0 + 1e-9))
    return np.asarray(np.array([1.0, 0.0, 0.0]) - share * (d + _UP))


def turned(
    q: ArrayLike, u: ArrayLike, direction: ArrayLike, axis: ArrayLike, to: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Q and U (..., C) by an axis, from those by another one.

    Args:
        q, u: (..., C) by `axis`.
        direction: unit vectors (..., 3) to where the light comes from.
        axis, to: (..., 3) unit vectors across the direction.
    """
    q, u, first, second = (np.asarray(part, dtype=float) for part in (q, u, axis, to))
    cosine = np.sum(first * second, axis=-1, keepdims=True)
    sine = np.sum(np.cross(first, np.asarray(direction)) * second, axis=-1, keepdims=True)
    along, across = (cosine - sine) * (cosine + sine), 2.0 * cosine * sine
    return q * along + u * across, u * along - q * across


def vertical_axis(direction: ArrayLike) -> FloatArray:
    """Axis (..., 3) in the vertical plane of unit directions (..., 3), upwards; -Z is the azimuth
    of zenith and nadir."""
    d = np.asarray(direction, dtype=float)
    level = np.hypot(d[..., 0], d[..., 2])[..., None]
    heading = np.divide(d, level, out=np.broadcast_to([0.0, 0.0, -1.0], d.shape).copy(),
                        where=level > 0.0)  # fmt: skip
    heading[..., 1] = 0.0
    return np.asarray(level * _UP - d[..., 1:2] * heading)


def degree_and_angle(
    radiance: ArrayLike, q: ArrayLike, u: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Degree of polarisation, 0 to 1, and angle of the vibration from the axis in radians, from
    -pi / 2 to pi / 2; both (...,), 0 where there is no light."""
    light, q, u = np.broadcast_arrays(*(np.asarray(part, float) for part in (radiance, q, u)))
    degree = np.divide(np.hypot(q, u), light, out=np.zeros_like(light), where=light > 0.0)
    return np.minimum(degree, 1.0), 0.5 * np.arctan2(u, q)

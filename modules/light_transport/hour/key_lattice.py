"""Directions 1.5 degrees apart, between which shadows of the key light are interpolated.

A shadow ray is lit or not: towards the key light itself a patch of few rays would brighten in steps
while time plays. Between three fixed directions its light changes linearly, and hours that follow
each other mostly share them. Shadows have edges as soft as if the sun were three times as wide:
less than a texel where it matters.

The directions are the crossings of a lattice on the square of Shirley and Chiu's map
(`sky_nodes`), each of whose cells is cut into two triangles.
"""

import math

import numpy as np

from vrut_lite.numeric_types import FloatArray, Vector

_EDGE = 96
_QUARTER = 0.25 * math.pi
# Sine of more than the angle between a direction and those around it.
FARTHEST = 0.06


def directions_around(direction: Vector) -> tuple[list[int], FloatArray]:
    """Numbers of three fixed directions around a unit vector, and their weights (3,).

    Weights are continuous in the direction and sum up to 1; from below the horizon it is moved
    there.
    """
    a, b = _on_square(*direction)
    x, y = 0.5 * (a + 1.0) * _EDGE, 0.5 * (b + 1.0) * _EDGE
    i, j = min(int(x), _EDGE - 1), min(int(y), _EDGE - 1)
    u, v = x - i, y - j
    if u + v <= 1.0:
        corners, weights = [(i, j), (i + 1, j), (i, j + 1)], [1.0 - u - v, u, v]
    else:
        corners = [(i + 1, j + 1), (i, j + 1), (i + 1, j)]
        weights = [u + v - 1.0, 1.0 - u, 1.0 - v]
    return [column * (_EDGE + 1) + row for column, row in corners], np.array(weights)


def direction_of(number: int) -> FloatArray:
    """The fixed direction (3,) of a number, unit, not below the horizon."""
    a, b = (2.0 * place / _EDGE - 1.0 for place in divmod(number, _EDGE + 1))
    if a == b == 0.0:
        return np.array([0.0, 1.0, 0.0])
    if abs(a) > abs(b):
        radius, angle = a, _QUARTER * b / a
    else:
        radius, angle = b, _QUARTER * (2.0 - a / b)
    across = radius * math.sqrt(2.0 - radius * radius)
    up = 1.0 - radius * radius
    return np.array([across * math.cos(angle), up, across * math.sin(angle)])


def _on_square(x: float, y: float, z: float) -> tuple[float, float]:
    """Where a direction lies in [-1, 1]^2."""
    radius = math.sqrt(1.0 - min(max(y, 0.0), 1.0))
    angle = math.atan2(z, x)
    if angle < -_QUARTER:
        angle += 2.0 * math.pi
    side, along = divmod(angle + _QUARTER, 2.0 * _QUARTER)
    along = radius * (along / _QUARTER - 1.0)
    if side == 0.0:
        return radius, along
    if side == 1.0:
        return -along, radius
    if side == 2.0:
        return -radius, -along
    return along, -radius

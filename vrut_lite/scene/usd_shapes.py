"""USD's spheres, cubes, capsules, cylinders, cones and planes as triangles.

Curved ones have 48 sides, and lie inside the shape by 0.2 % of its radius at most.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

SHAPES = ("Sphere", "Cube", "Capsule", "Cylinder", "Cone", "Plane")
_SIDES = 48
# The axes' numbers of places by which columns of Z-up points are rolled.
_ROLLS = {"Z": 0, "X": 1, "Y": 2}
_CORNERS = np.array([(x, y, z) for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
_SQUARES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def shape_triangles(prim: Any, time: Any) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Points (V, 3) and triangles (F, 3), counter-clockwise from outside, of a prim in `SHAPES`."""

    def value(name: str) -> Any:
        return prim.GetAttribute(name).Get(time)

    kind = prim.GetTypeName()
    if kind == "Cube":
        return _CORNERS * value("size"), _halves(_SQUARES)
    roll = 0 if kind == "Sphere" else _ROLLS[value("axis")]
    if kind == "Plane":
        # Rolled, width lies along X, or Z for an X plane, and length along the other axis.
        sides = (value("width"), value("length"))[:: 1 if roll == 0 else -1]
        points = _CORNERS[:4] * (*sides, 0.0)
        return np.roll(points, roll, axis=1), _halves([(0, 1, 3, 2)])
    radius = value("radius")
    half = 0.0 if kind == "Sphere" else 0.5 * value("height")
    arc = np.linspace(0.0, 0.5 * np.pi, _SIDES // 4 + 1)
    profile = {
        "Cylinder": [(0.0, -half), (radius, -half), (radius, half), (0.0, half)],
        "Cone": [(0.0, -half), (radius, -half), (0.0, half)],
    }.get(kind)
    if profile is None:
        lower = np.stack([radius * np.sin(arc), -half - radius * np.cos(arc)], axis=1)
        profile = [*lower, *(lower[::-1] * (1.0, -1.0))]
    points, triangles = _revolved(np.array(profile))
    return np.roll(points, roll, axis=1), triangles


def _halves(squares: list[tuple[int, int, int, int]]) -> NDArray[np.int64]:
    corners = np.array(squares)
    return corners[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def _revolved(
    profile: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The surface that a profile (n, 2) of radii and heights, upwards, describes about Z."""
    angle = np.arange(_SIDES) * (2.0 * np.pi / _SIDES)
    radius, height = profile.T[:, :, None]
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    points = np.stack(np.broadcast_arrays(x, y, height), axis=-1).reshape(-1, 3)
    first = _SIDES * np.arange(len(profile) - 1)[:, None] + np.arange(_SIDES)
    beside = first - np.arange(_SIDES) + np.roll(np.arange(_SIDES), -1)
    squares = np.stack([first, beside, beside + _SIDES, first + _SIDES], axis=-1)
    triangles = squares[..., [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    # At a pole the sides of squares have no length.
    return points, triangles[np.any(np.cross(b - a, c - a) != 0.0, axis=1)]

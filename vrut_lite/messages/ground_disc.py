"""The ground disc for a scene without a ground that reaches the horizon.

It curves with the planet, so that at its rim, through air and from high up, it continues as the
sky's own ground.
"""

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.atmosphere.planet import GROUND_RADIUS_M

# In radii of the scene: the rim lies near the horizon, where the sky's lower half, of the same
# radiance, continues.
_RADII = 60.0
_SEGMENTS = 96
# The Earth's, for every atmosphere.
# Beyond it the parabola of `fall_m` is no longer accurate.
_WIDEST_M = 2e5
# Depth of the disc below the scene's base, in radii of the scene, so that floors do not flicker.
_DROP = 2e-3


class GroundDisc(msgspec.Struct, frozen=True):
    """A disc at a height, around a point (x, z) where it is level; metres, world axes."""

    centre_xz_m: tuple[float, float]
    height_m: float
    radius_m: float


def disc_under(lower_m: ArrayLike, upper_m: ArrayLike) -> GroundDisc:
    """The ground for a scene of these bounds."""
    lower, upper = np.asarray(lower_m, dtype=float), np.asarray(upper_m, dtype=float)
    radius = 0.5 * float(np.linalg.norm(upper - lower))
    centre = 0.5 * (lower + upper)
    return GroundDisc(
        centre_xz_m=(float(centre[0]), float(centre[2])),
        height_m=float(lower[1]) - _DROP * radius,
        radius_m=min(_RADII * radius, _WIDEST_M),
    )


def fall_m(across_m: ArrayLike) -> NDArray[np.float64]:
    """Drop (...,) of the ground below level, in m, at distances (...,) from the disc's middle."""
    return np.square(np.asarray(across_m, dtype=float)) / (2.0 * GROUND_RADIUS_M)


# Number of inner rings; they reach to a 27th of the radius.
_INNER_RINGS = 3


def inner_and_outer(
    disc: GroundDisc,
) -> tuple[tuple[NDArray[np.float32], NDArray[np.uint32]], ...]:
    """The disc in two parts with a common edge, each as `triangulate` gives all of it.

    The inner part lies near an eye in the scene and needs no effects of distance.
    """
    vertices, triangles = triangulate(disc)
    # The middle's fan, and two triangles a segment of each further ring.
    end = _SEGMENTS * (2 * _INNER_RINGS - 1)
    first = 1 + (_INNER_RINGS - 1) * _SEGMENTS
    inner = vertices[: first + _SEGMENTS], triangles[:end]
    return inner, (vertices[first:], triangles[end:] - np.uint32(first))


def triangulate(disc: GroundDisc) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Vertices (n, 3), from the disc's middle, and triangles (m, 3), seen from above.

    Each ring has a third of the next one's radius: interpolation over one huge triangle would
    lose the precision that shadows near the scene need.
    """
    angle = 2 * np.pi * np.arange(_SEGMENTS) / _SEGMENTS
    radii = disc.radius_m * 3.0 ** -np.arange(6.0)[::-1]
    rim = np.stack([np.cos(angle), np.zeros_like(angle), -np.sin(angle)], axis=-1)
    down = np.array([0.0, -1.0, 0.0])
    rings = (radius * rim + fall_m(radius) * down for radius in radii)
    vertices = np.concatenate([np.zeros((1, 3)), *rings])
    i, j = np.arange(_SEGMENTS), (np.arange(_SEGMENTS) + 1) % _SEGMENTS
    triangles = [np.stack([np.zeros_like(i), 1 + i, 1 + j], axis=-1)]
    for ring in range(len(radii) - 1):
        inner, outer = 1 + ring * _SEGMENTS, 1 + (ring + 1) * _SEGMENTS
        triangles.append(np.stack([inner + i, outer + i, outer + j], axis=-1))
        triangles.append(np.stack([inner + i, outer + j, inner + j], axis=-1))
    return vertices.astype(np.float32), np.concatenate(triangles).astype(np.uint32)

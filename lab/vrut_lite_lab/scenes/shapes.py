"""Building blocks of the scenes: triangles with normals and texture coordinates, in metres."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.numeric_types import FloatArray


@dataclass(frozen=True)
class PlainMesh:
    """Positions (V, 3), unit normals (V, 3), texture coordinates (V, 2) in metres, faces (F, 3).

    Texture coordinates run with v downwards, as glTF has them.
    """

    positions: FloatArray
    normals: FloatArray
    uv: FloatArray
    faces: NDArray[np.int64]

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> "PlainMesh":
        """The shape at another place."""
        return PlainMesh(self.positions + np.array([x, y, z]), self.normals, self.uv, self.faces)

    def turned(self, azimuth_deg: float) -> "PlainMesh":
        """The shape turned about the vertical axis, clockwise seen from above."""
        c, s = np.cos(np.radians(azimuth_deg)), np.sin(np.radians(azimuth_deg))
        turn = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]]).T
        return PlainMesh(self.positions @ turn, self.normals @ turn, self.uv, self.faces)

    def textured_every(self, size_m: float) -> "PlainMesh":
        """The shape with a texture that repeats each so many metres."""
        return PlainMesh(self.positions, self.normals, self.uv / size_m, self.faces)


def joined(shapes: Sequence[PlainMesh]) -> PlainMesh:
    """Several shapes as one."""
    starts = np.cumsum([0, *(len(shape.positions) for shape in shapes[:-1])])
    return PlainMesh(
        np.concatenate([shape.positions for shape in shapes]),
        np.concatenate([shape.normals for shape in shapes]),
        np.concatenate([shape.uv for shape in shapes]),
        np.concatenate([shape.faces + start for shape, start in zip(shapes, starts, strict=True)]),
    )


def polygon(corners: ArrayLike) -> PlainMesh:
    """A flat convex polygon (N, 3), counter-clockwise seen from its front."""
    points = np.asarray(corners, dtype=float)
    normal = np.cross(points[1] - points[0], points[2] - points[0])
    normal /= np.linalg.norm(normal)
    # Texture upright on walls; on floors its top is to the north.
    up = np.array([0.0, 1.0, 0.0]) if abs(normal[1]) < 0.99 else np.array([0.0, 0.0, -1.0])
    right = np.cross(up, normal)
    right /= np.linalg.norm(right)
    uv = np.stack([points @ right, -(points @ np.cross(normal, right))], axis=1)
    middle = np.arange(1, len(points) - 1)
    faces = np.stack([np.zeros_like(middle), middle, middle + 1], axis=1)
    return PlainMesh(points, np.tile(normal, (len(points), 1)), uv, faces)


def box(lower: ArrayLike, upper: ArrayLike) -> PlainMesh:
    """A box between two corners."""
    (x0, y0, z0), (x1, y1, z1) = np.asarray(lower, float), np.asarray(upper, float)
    return joined(
        [
            polygon([(x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1)]),
            polygon([(x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)]),
            polygon([(x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0)]),
            polygon([(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)]),
            polygon([(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)]),
            polygon([(x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0)]),
        ]
    )


def relief(lower: ArrayLike, upper: ArrayLike) -> PlainMesh:
    """A box that stands on a wall to its west: without its west face."""
    whole = box(lower, upper)
    keep = np.r_[0:4, 8:24]
    faces = np.concatenate([whole.faces[:2], whole.faces[4:] - 4])
    return PlainMesh(whole.positions[keep], whole.normals[keep], whole.uv[keep], faces)


def lathe(profile: ArrayLike, segments: int, *, smooth: bool = False) -> PlainMesh:
    """A body of revolution about the vertical axis.

    Args:
        profile: (N, 2) radius and height, upwards for an outside.
        segments: around the axis, where it is always smooth.
        smooth: also along the profile; otherwise each of its pieces has its own normals.
    """
    points = np.asarray(profile, dtype=float)
    if smooth:
        return _revolved(points, _profile_normals(points), segments)
    pieces = [points[i : i + 2] for i in range(len(points) - 1)]
    return joined([_revolved(piece, _profile_normals(piece), segments) for piece in pieces])


def disc(radius_m: float, height_m: float, segments: int, inner_m: float = 0.0) -> PlainMesh:
    """A level disc or ring that faces up, its texture laid from above."""
    flat = lathe([(radius_m, height_m), (inner_m, height_m)], segments)
    return PlainMesh(flat.positions, flat.normals, flat.positions[:, [0, 2]], flat.faces)


def sector(
    radii_m: tuple[float, float], azimuths_deg: tuple[float, float], height_m: float
) -> PlainMesh:
    """A level piece of a ring that faces up, between two azimuths (from north, clockwise)."""
    count = max(int(np.ceil((azimuths_deg[1] - azimuths_deg[0]) / 3.0)), 1)
    azimuth = np.radians(np.linspace(*azimuths_deg, count + 1))
    rim = np.stack([np.sin(azimuth), np.zeros_like(azimuth), -np.cos(azimuth)], axis=1)
    positions = np.concatenate([radius * rim for radius in radii_m])
    positions[:, 1] = height_m
    inner = np.arange(count)
    outer = inner + count + 1
    faces = np.concatenate(
        [
            np.stack([inner, inner + 1, outer], axis=1),
            np.stack([inner + 1, outer + 1, outer], axis=1),
        ]
    )
    normals = np.tile([0.0, 1.0, 0.0], (len(positions), 1))
    return PlainMesh(positions, normals, positions[:, [0, 2]], faces)


def sphere(radius_m: float, segments: int) -> PlainMesh:
    """A ball about the origin."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, segments // 2 + 1)
    profile = radius_m * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    profile[[0, -1], 0] = 0.0
    return lathe(profile, segments, smooth=True)


def obelisk(width_m: float, top_width_m: float, shaft_m: float, height_m: float) -> PlainMesh:
    """A square, tapering shaft with a pyramid on top, its base at the origin."""
    lower, upper = _square(width_m / 2, 0.0), _square(top_width_m / 2, shaft_m)
    tip = (0.0, height_m, 0.0)
    sides = []
    for i in range(4):
        j = (i + 1) % 4
        sides += [
            polygon([lower[i], lower[j], upper[j], upper[i]]),
            polygon([upper[i], upper[j], tip]),
        ]
    return joined(sides)


def _square(half_m: float, height_m: float) -> list[tuple[float, float, float]]:
    """Corners counter-clockwise seen from above."""
    return [
        (-half_m, height_m, half_m),
        (half_m, height_m, half_m),
        (half_m, height_m, -half_m),
        (-half_m, height_m, -half_m),
    ]


def _profile_normals(points: FloatArray) -> FloatArray:
    """Outward unit normals (N, 2) of a profile that runs upwards outside."""
    along = np.gradient(points, axis=0)
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def _revolved(points: FloatArray, normals: FloatArray, segments: int) -> PlainMesh:
    turn = np.linspace(0.0, 2 * np.pi, segments + 1)
    turn[-1] = 0.0  # The seam closes exactly.
    around = np.stack([np.sin(turn), np.zeros_like(turn), np.cos(turn)], axis=1)
    positions = points[:, None, :1] * around + points[:, None, 1:] * [0.0, 1.0, 0.0]
    directions = normals[:, None, :1] * around + normals[:, None, 1:] * [0.0, 1.0, 0.0]
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    arc = np.linspace(0.0, 2 * np.pi, segments + 1) * points[:, 0].max()
    u, v = np.meshgrid(arc, -length)
    faces = _grid_faces(len(points), segments + 1)
    corners = positions.reshape(-1, 3)[faces]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    return PlainMesh(
        positions.reshape(-1, 3),
        directions.reshape(-1, 3),
        np.stack([u.reshape(-1), v.reshape(-1)], axis=1),
        faces[area > 1e-9],
    )


def _grid_faces(rows: int, columns: int) -> NDArray[np.int64]:
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b = index[:-1, :-1].reshape(-1), index[:-1, 1:].reshape(-1)
    c, d = index[1:, 1:].reshape(-1), index[1:, :-1].reshape(-1)
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])

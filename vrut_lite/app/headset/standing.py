"""Where a headset's room stands in the scene: poses, teleport and snap turns.

OpenXR's axes are the world's: metres, right-handed, x right, y up, -z forward. A room is placed by
a turn about the vertical and a shift, so that up stays up.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.frame_part import Hit
from vrut_lite.numeric_types import FloatArray

# The nearest surface along a ray from a point (3,) in a unit direction (3,); None for the sky.
FirstHit = Callable[[ArrayLike, ArrayLike], Hit | None]
# Cosine of the steepest slope that one can stand on, 45 degrees.
_STEEPEST = math.cos(math.radians(45.0))
# Longest teleport, and the height above its target that must be free.
_FARTHEST_M, _HEADROOM_M = 50.0, 1.8
# Distance from a surface at which a ray starts.
_OFF_SURFACE_M = 1e-3
_DOWN = (0.0, -1.0, 0.0)
_UP = (0.0, 1.0, 0.0)


@dataclass(frozen=True)
class RoomPose:
    """A position (3,) in metres, and a rotation (3, 3) from the pose's axes to those around it."""

    position_m: FloatArray
    rotation: FloatArray

    @property
    def forward(self) -> FloatArray:
        """Unit vector (3,) of the pose's -z."""
        return -self.rotation[:, 2]


def rotation_of(quaternion: ArrayLike) -> FloatArray:
    """Rotation matrix (3, 3) of a quaternion (x, y, z, w) of any length but zero."""
    x, y, z, w = np.asarray(quaternion, dtype=float) / np.linalg.norm(quaternion)
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def azimuth_rad(forward: ArrayLike) -> float:
    """Azimuth of a direction (3,), from -z clockwise as seen from above (towards +x).

    Of a direction straight up or down it is that of +z or -z, 0 or pi.
    """
    x, _, z = np.asarray(forward, dtype=float)
    return math.atan2(x, -z)


@dataclass(frozen=True)
class Standing:
    """A room in the scene: its floor's origin (3,) in world axes, and its azimuth.

    The room's -z has `azimuth_rad` in the world, clockwise as seen from above.
    """

    origin_m: FloatArray
    azimuth_rad: float

    def in_world(self, pose: RoomPose) -> RoomPose:
        """A pose of the room in world axes."""
        turn = _turn(self.azimuth_rad)
        return RoomPose(self.origin_m + turn @ pose.position_m, turn @ pose.rotation)

    def in_room(self, point_m: ArrayLike) -> FloatArray:
        """A point (3,) of the world in the room's axes; the inverse of `in_world`."""
        away_m = np.asarray(point_m, dtype=float) - self.origin_m
        return np.asarray(_turn(self.azimuth_rad).T @ away_m)

    def with_head_at(self, floor_m: ArrayLike, head: RoomPose) -> "Standing":
        """The room shifted so that a head (in the room) is above a point (3,) of the floor."""
        over = _turn(self.azimuth_rad) @ (head.position_m * (1.0, 0.0, 1.0))
        return Standing(np.asarray(floor_m, dtype=float) - over, self.azimuth_rad)

    def turned(self, angle_rad: float, head: RoomPose) -> "Standing":
        """The room turned clockwise about a head (in the room), which stays where it is."""
        below = self.in_world(head).position_m
        below[1] = self.origin_m[1]
        turned = Standing(self.origin_m, math.remainder(self.azimuth_rad + angle_rad, math.tau))
        return turned.with_head_at(below, head)


def standing_at(floor_m: ArrayLike, towards_rad: float, head: RoomPose) -> Standing:
    """The room in which a head is above a point (3,) of the floor and looks along an azimuth."""
    azimuth = math.remainder(towards_rad - azimuth_rad(head.forward), math.tau)
    return Standing(np.zeros(3), azimuth).with_head_at(floor_m, head)


def floor_below(eye_m: ArrayLike, first_hit: FirstHit) -> FloatArray | None:
    """The point (3,) of the scene straight below an eye (3,); None over nothing."""
    hit = first_hit(eye_m, _DOWN)
    return None if hit is None else hit.point_m


def teleport_target(hand: RoomPose, first_hit: FirstHit) -> FloatArray | None:
    """The point (3,) of the scene that a hand (in world axes) points at, to stand on.

    None where it is the sky, farther than 50 m, steeper than 45 degrees, or without room for a
    body of 1.8 m.
    """
    hit = first_hit(hand.position_m, hand.forward)
    if hit is None or hit.normal[1] < _STEEPEST:
        return None
    if float(np.linalg.norm(hit.point_m - hand.position_m)) > _FARTHEST_M:
        return None
    above = first_hit(hit.point_m + _OFF_SURFACE_M * np.array(_UP), _UP)
    if above is not None and above.point_m[1] - hit.point_m[1] < _HEADROOM_M:
        return None
    return hit.point_m


def _turn(azimuth: float) -> FloatArray:
    """Rotation (3, 3) about +y that turns -z to an azimuth."""
    c, s = math.cos(azimuth), math.sin(azimuth)
    return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])

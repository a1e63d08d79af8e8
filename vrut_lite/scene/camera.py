"""Cameras: matrices, and a view that frames a scene."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.numeric_types import Vector

DEFAULT_FIELD_OF_VIEW_RAD = 0.75
# From the south-west and a little above, as if standing at the scene's edge.
_DEFAULT_AZIMUTH_RAD = np.radians(215.0)
_DEFAULT_ELEVATION_RAD = np.radians(14.0)
_DRAWABLE_FIELD_OF_VIEW_RAD = np.radians([1.0, 150.0])
_ROOM = 1.08  # a little air around the scene


def look_at(eye_m: ArrayLike, target_m: ArrayLike) -> NDArray[np.float64]:
    """View matrix (4, 4), world to camera (-Z forward), upright unless looking straight along Y.

    Looking straight down or up, north (-Z) is at the top of the picture.
    """
    eye = np.asarray(eye_m, dtype=float)
    forward = np.asarray(target_m, dtype=float) - eye
    forward /= np.linalg.norm(forward)
    vertical = abs(forward[1]) > 1.0 - 1e-9
    up_hint = np.array([0.0, 0.0, -1.0]) if vertical else np.array([0.0, 1.0, 0.0])
    right = np.cross(forward, up_hint)
    right /= np.linalg.norm(right)
    rotation = np.array([right, np.cross(right, forward), -forward])
    view = np.eye(4)
    view[:3, :3] = rotation
    view[:3, 3] = -rotation @ eye
    return view


def perspective(
    vertical_field_of_view_rad: float, aspect: float, near_m: float
) -> NDArray[np.float64]:
    """Projection matrix (4, 4) to reversed depth: near / distance, 0 at infinity.

    Aspect is width over height.
    """
    f = 1.0 / np.tan(0.5 * vertical_field_of_view_rad)
    return np.array([[f / aspect, 0, 0, 0], [0, f, 0, 0], [0, 0, 0, near_m], [0, 0, -1, 0]])


def frame_bounds(lower_m: ArrayLike, upper_m: ArrayLike, aspect: float) -> MoveCamera:
    """A camera from the south-west whose picture, of this aspect, the bounds just fill."""
    lower, upper = np.asarray(lower_m, dtype=float), np.asarray(upper_m, dtype=float)
    centre = 0.5 * (lower + upper)
    half = np.maximum(0.5 * (upper - lower), 1e-3)
    away = _away()
    rotation = look_at(away, np.zeros(3))[:3, :3]
    signs = np.array(list(np.ndindex(2, 2, 2))) * 2.0 - 1.0
    right, up, back = np.moveaxis((signs * half) @ rotation.T, -1, 0)
    tangent = np.tan(0.5 * DEFAULT_FIELD_OF_VIEW_RAD)
    # Each corner asks for the distance at which it lies on the picture's edge.
    distance = np.max(back + np.maximum(np.abs(right) / aspect, np.abs(up)) / tangent)
    return MoveCamera(
        eye_m=_vector(centre + _ROOM * distance * away),
        target_m=_vector(centre),
        vertical_field_of_view_rad=DEFAULT_FIELD_OF_VIEW_RAD,
    )


def _away() -> NDArray[np.float64]:
    """Unit vector from the scene towards the default camera."""
    east = np.cos(_DEFAULT_ELEVATION_RAD) * np.sin(_DEFAULT_AZIMUTH_RAD)
    north = np.cos(_DEFAULT_ELEVATION_RAD) * np.cos(_DEFAULT_AZIMUTH_RAD)
    return np.array([east, np.sin(_DEFAULT_ELEVATION_RAD), -north])


def camera_from_pose(pose: ArrayLike, vertical_field_of_view_rad: float) -> MoveCamera:
    """A camera from a glTF camera node's world pose (4, 4); its angle is kept drawable."""
    matrix = np.asarray(pose, dtype=float)
    eye, forward = matrix[:3, 3], -matrix[:3, 2]
    return MoveCamera(
        eye_m=_vector(eye),
        target_m=_vector(eye + forward / np.linalg.norm(forward)),
        vertical_field_of_view_rad=float(
            np.clip(vertical_field_of_view_rad, *_DRAWABLE_FIELD_OF_VIEW_RAD)
        ),
    )


def _vector(values: NDArray) -> Vector:
    return (float(values[0]), float(values[1]), float(values[2]))

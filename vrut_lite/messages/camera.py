"""The camera: as the user moves it, as a scene brings it, and the rays through its pixels."""

import math
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite import checks
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Input
from vrut_lite.numeric_types import FloatArray, Vector, vector

DEFAULT_FIELD_OF_VIEW_RAD = 0.75
# From the south-west and a little above, as if standing at the scene's edge.
_DEFAULT_AZIMUTH_RAD = np.radians(215.0)
_DEFAULT_ELEVATION_RAD = np.radians(14.0)
_DRAWABLE_FIELD_OF_VIEW_RAD = np.radians([1.0, 150.0])
# Distance of the framing camera, as a multiple of that at which the bounds touch the border.
_FRAMING_MARGIN = 1.08


class MoveCamera(Input, frozen=True, kw_only=True):
    """Look from `eye_m` to `target_m`, world axes."""

    revises: ClassVar[bool] = False

    eye_m: Vector
    target_m: Vector
    vertical_field_of_view_rad: float = 0.8

    def check(self) -> None:
        """From one point to another, at a possible angle."""
        checks.numbers(self, "eye_m", 3, of="a camera")
        checks.numbers(self, "target_m", 3, of="a camera")
        if self.eye_m == self.target_m:
            raise UserError("the camera's eye and target are one point: move one of them")
        angle = self.vertical_field_of_view_rad
        if not (checks.is_finite(angle) and 0.0 < angle < math.pi):
            raise UserError(
                "vertical_field_of_view_rad of a camera must lie between 0 and pi, not "
                f"{checks.shown(angle)}"
            )

    def pixel_rad(self, height_px: int) -> float:
        """The angle that a pixel in the middle of a picture of such a height sees."""
        return 2.0 * math.tan(0.5 * self.vertical_field_of_view_rad) / height_px


def look_at(eye_m: ArrayLike, target_m: ArrayLike) -> FloatArray:
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


def perspective(vertical_field_of_view_rad: float, aspect: float, near_m: float) -> FloatArray:
    """Projection matrix (4, 4) to reversed depth: near / distance, 0 at infinity.

    Aspect is width over height.
    """
    f = 1.0 / np.tan(0.5 * vertical_field_of_view_rad)
    return np.array([[f / aspect, 0, 0, 0], [0, f, 0, 0], [0, 0, 0, near_m], [0, 0, -1, 0]])


def off_axis_perspective(tangents: ArrayLike, near_m: float) -> FloatArray:
    """Projection matrix (4, 4) to reversed depth, as `perspective`, of a view without symmetry.

    `tangents` of the angles from the axis to the left, right, lower and upper edge; left and lower
    ones of an eye are negative.
    """
    left, right, lower, upper = np.asarray(tangents, dtype=float)
    width, height = right - left, upper - lower
    return np.array(
        [
            [2.0 / width, 0.0, (right + left) / width, 0.0],
            [0.0, 2.0 / height, (upper + lower) / height, 0.0],
            [0.0, 0.0, 0.0, near_m],
            [0.0, 0.0, -1.0, 0.0],
        ]
    )


def rays_through(camera: MoveCamera, aspect: float, right: ArrayLike, up: ArrayLike) -> FloatArray:
    """Unit world directions (..., 3) through points of the picture.

    `right` and `up` (...,) count from the picture's middle, 1 at its border; `aspect` is width
    over height.
    """
    tangent = np.tan(0.5 * camera.vertical_field_of_view_rad)
    parts = np.asarray(right) * tangent * aspect, np.asarray(up) * tangent, np.float64(-1.0)
    local = np.stack(np.broadcast_arrays(*parts), axis=-1)
    directions = local @ look_at(np.zeros(3), np.subtract(camera.target_m, camera.eye_m))[:3, :3]
    return np.asarray(directions / np.linalg.norm(directions, axis=-1, keepdims=True))


def pixel_rays(
    camera: MoveCamera, size_px: tuple[int, int], x: ArrayLike, y: ArrayLike
) -> FloatArray:
    """Unit world directions (..., 3) through the middles of pixels; y counts from the top."""
    width, height = size_px
    right = 2.0 * (np.asarray(x) + 0.5) / width - 1.0
    up = 1.0 - 2.0 * (np.asarray(y) + 0.5) / height
    return rays_through(camera, width / height, right, up)


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
        eye_m=vector(centre + _FRAMING_MARGIN * distance * away),
        target_m=vector(centre),
        vertical_field_of_view_rad=DEFAULT_FIELD_OF_VIEW_RAD,
    )


def _away() -> FloatArray:
    """Unit vector from the scene towards the default camera."""
    east = np.cos(_DEFAULT_ELEVATION_RAD) * np.sin(_DEFAULT_AZIMUTH_RAD)
    north = np.cos(_DEFAULT_ELEVATION_RAD) * np.cos(_DEFAULT_AZIMUTH_RAD)
    return np.array([east, np.sin(_DEFAULT_ELEVATION_RAD), -north])


def camera_from_pose(pose: ArrayLike, vertical_field_of_view_rad: float) -> MoveCamera:
    """A camera from a glTF camera node's world pose (4, 4); its angle is kept drawable."""
    matrix = np.asarray(pose, dtype=float)
    eye, forward = matrix[:3, 3], -matrix[:3, 2]
    return MoveCamera(
        eye_m=vector(eye),
        target_m=vector(eye + forward / np.linalg.norm(forward)),
        vertical_field_of_view_rad=float(
            np.clip(vertical_field_of_view_rad, *_DRAWABLE_FIELD_OF_VIEW_RAD)
        ),
    )

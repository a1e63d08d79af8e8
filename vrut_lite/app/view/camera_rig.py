"""Cameras moved by hand: around a point, through the air, and from the ground to space."""

import math

import numpy as np

from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.numeric_types import FloatArray, Vector, vector

_STEEPEST_RAD = math.radians(89.5)
_TURN_PER_VIEW_RAD = math.pi
_NEAREST_M, _FARTHEST_M = 0.05, 5e7
# A step of the wheel: a tenth nearer, an eighth higher.
_ZOOM, _CLIMB = 0.9, 1.125
# Height of the eyes of one who stands.
EYE_HEIGHT_M = 1.7
_HIGHEST_M = 4e7
# The Earth's radius: it affects only the view's tilt with height.
NARROWEST_RAD, WIDEST_RAD = math.radians(5.0), math.radians(120.0)


class CameraRig:
    """An eye, a direction and a distance to the target; angles in radians, metres.

    `azimuth_rad` is that of the view, from -Z clockwise (towards +X), `elevation_rad` its height.
    """

    def __init__(self) -> None:
        self.eye_m: FloatArray = np.array([0.0, EYE_HEIGHT_M, 10.0])
        self.azimuth_rad = 0.0
        self.elevation_rad = 0.0
        self.distance_m = 10.0
        self.field_of_view_rad = 0.8

    # --- state -----------------------------------------------------------------------------

    @property
    def forward(self) -> FloatArray:
        """Unit vector of the view."""
        flat = math.cos(self.elevation_rad)
        return np.array(
            [
                flat * math.sin(self.azimuth_rad),
                math.sin(self.elevation_rad),
                -flat * math.cos(self.azimuth_rad),
            ]
        )

    @property
    def right(self) -> FloatArray:
        """Unit vector to the right, level."""
        return np.array([math.cos(self.azimuth_rad), 0.0, math.sin(self.azimuth_rad)])

    @property
    def target_m(self) -> FloatArray:
        """The point around which it turns."""
        return self.eye_m + self.distance_m * self.forward

    def camera(self) -> MoveCamera:
        """The input that moves the camera here."""
        return MoveCamera(
            eye_m=vector(self.eye_m),
            target_m=vector(self.target_m),
            vertical_field_of_view_rad=self.field_of_view_rad,
        )

    def adopt(self, camera: MoveCamera, centre_m: FloatArray | None = None) -> None:
        """Take over a camera; the target is the point of its view line nearest to `centre_m`."""
        eye, target = np.array(camera.eye_m), np.array(camera.target_m)
        way = target - eye
        length = float(np.linalg.norm(way))
        forward = way / length
        self.eye_m = eye
        self.azimuth_rad = math.atan2(forward[0], -forward[2])
        self.elevation_rad = math.asin(float(np.clip(forward[1], -1.0, 1.0)))
        self.field_of_view_rad = camera.vertical_field_of_view_rad
        along = length if centre_m is None else float((centre_m - eye) @ forward)
        self.distance_m = along if along > _NEAREST_M else length

    # --- motion ----------------------------------------------------------------------------

    def orbit(self, right: float, up: float, lowest_m: float = -math.inf) -> None:
        """Turn around the target, by fractions of the view's height, as if dragging the scene.

        An eye above `lowest_m` stays above it, one below goes no lower.
        """
        target, lowest_m = self.target_m, min(lowest_m, float(self.eye_m[1]))
        self.look(-right, -up)
        steepest = (target[1] - lowest_m) / self.distance_m
        self._tilt(min(self.elevation_rad, math.asin(min(max(steepest, -1.0), 1.0))))
        self.eye_m = target - self.distance_m * self.forward

    def look(self, right: float, up: float) -> None:
        """Turn the view by fractions of its height."""
        self.azimuth_rad = math.remainder(
            self.azimuth_rad + right * _TURN_PER_VIEW_RAD, 2.0 * math.pi
        )
        self._tilt(self.elevation_rad + up * _TURN_PER_VIEW_RAD)

    def look_along(self, direction: Vector) -> None:
        """Turn the view to a unit vector in world axes."""
        x, y, z = direction
        self.azimuth_rad = math.atan2(x, -z)
        self._tilt(math.asin(min(max(y, -1.0), 1.0)))

    def look_around(self, right: float, up: float) -> None:
        """Turn the view so that the point under the pointer stays under it."""
        share = self.field_of_view_rad / _TURN_PER_VIEW_RAD
        self.look(-right * share, -up * share)

    def pan(self, right: float, up: float) -> None:
        """Shift eye and target by fractions of the view's extent at the target."""
        span_m = 2.0 * self.distance_m * math.tan(0.5 * self.field_of_view_rad)
        upward = np.cross(self.right, self.forward)
        self.eye_m = self.eye_m - span_m * (right * self.right + up * upward)

    def dolly(self, steps: float) -> None:
        """Go nearer to the target, or away for negative steps."""
        target = self.target_m
        wanted_m = self.distance_m * _ZOOM**steps
        self.distance_m = min(max(wanted_m, _NEAREST_M), _FARTHEST_M)
        self.eye_m = target - self.distance_m * self.forward

    def zoom(self, steps: float) -> None:
        """A narrower view, or a wider one for negative steps."""
        wanted = self.field_of_view_rad * _ZOOM**steps
        self.field_of_view_rad = min(max(wanted, NARROWEST_RAD), WIDEST_RAD)

    def fly(self, right_m: float, up_m: float, forward_m: float) -> None:
        """Move by metres to the right, up, and along the view."""
        way = right_m * self.right + np.array([0.0, up_m, 0.0]) + forward_m * self.forward
        self.eye_m = self.eye_m + way

    def climb(self, steps: float) -> None:
        """Rise by an eighth of the height a step, or sink; the horizon stays in place."""
        above_m = max(self.eye_m[1], 0.0) + 2.0 * EYE_HEIGHT_M
        height_m = above_m * _CLIMB**steps - 2.0 * EYE_HEIGHT_M
        self.rise_to(height_m)

    def rise_to(self, height_m: float) -> None:
        """Set the height; the view keeps its angle above the horizon."""
        above_rad = self.elevation_rad + dip_rad(self.eye_m[1])
        height_m = min(max(height_m, EYE_HEIGHT_M), _HIGHEST_M)
        self.eye_m = np.array([self.eye_m[0], height_m, self.eye_m[2]])
        self._tilt(above_rad - dip_rad(height_m))

    def _tilt(self, elevation_rad: float) -> None:
        self.elevation_rad = min(max(elevation_rad, -_STEEPEST_RAD), _STEEPEST_RAD)


def dip_rad(height_m: float) -> float:
    """The dip of the planet's horizon below the level."""
    return math.acos(GROUND_RADIUS_M / (GROUND_RADIUS_M + max(height_m, 0.0)))


def height_text(height_m: float) -> str:
    """A height as text: metres up to 10 km, then kilometres."""
    return f"{height_m:,.1f} m" if abs(height_m) < 1e4 else f"{height_m / 1e3:,.1f} km"

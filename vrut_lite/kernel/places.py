"""Which places and cameras there are: what is none must reach no module."""

import math

from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import MoveCamera, SetPlace

# No ground is lower; geostationary orbit is higher than any observer of an atmosphere needs.
LOWEST_M, HIGHEST_M = -11_000.0, 36_000_000.0
_TURN_RAD = 6.3


def check_place(place: SetPlace) -> None:
    """Raise UserError unless every number of the place lies in its range."""
    for name, low, high in (
        ("latitude_deg", -90.0, 90.0),
        ("longitude_deg", -180.0, 180.0),
        ("altitude_m", LOWEST_M, HIGHEST_M),
        ("north_offset_rad", -_TURN_RAD, _TURN_RAD),
    ):
        value = getattr(place, name)
        # Written so that a NaN is refused too.
        if not low <= value <= high:
            raise UserError(f"{name} of a place must lie from {low:g} to {high:g}, not {value}")


def check_camera(camera: MoveCamera) -> None:
    """Raise UserError unless the camera looks from one point to another, at a possible angle."""
    for name in ("eye_m", "target_m"):
        value = getattr(camera, name)
        if not all(math.isfinite(part) for part in value):
            raise UserError(f"{name} of a camera must be three finite numbers, not {value}")
    if camera.eye_m == camera.target_m:
        raise UserError("the camera's eye and target are one point: move one of them")
    angle = camera.vertical_field_of_view_rad
    if not 0.0 < angle < math.pi:
        raise UserError(
            f"vertical_field_of_view_rad of a camera must lie between 0 and pi, not {angle}"
        )

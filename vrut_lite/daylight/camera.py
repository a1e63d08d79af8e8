"""The camera as the user moves it."""

import math

from vrut_lite import checks
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Input
from vrut_lite.numeric_types import Vector


class MoveCamera(Input, frozen=True, kw_only=True):
    """Look from `eye_m` to `target_m`, world axes."""

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

"""Placement of a scene file in the world: its unit, vertical axis, position and heading."""

import math
from typing import Annotated, Literal

import msgspec
import numpy as np

from vrut_lite import checks
from vrut_lite.numeric_types import FloatArray, Vector

UpAxis = Literal["y", "z"]
UP_AXES: tuple[UpAxis, ...] = ("y", "z")
LEAST_METRES_PER_UNIT, MOST_METRES_PER_UNIT = 1e-6, 1e6
# To +Y up from each vertical axis, turned about X.
_TO_Y_UP = {"y": np.eye(3), "z": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])}
_FARTHEST_M = 1e7


class Placement(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A file's axes in the world's. A value of None is read from the file, or guessed.

    Attributes:
        up: the file's vertical axis.
        metres_per_unit: the length of the file's unit.
        position_m: position of its origin, world axes.
        heading_deg: its turn about the vertical, clockwise seen from above.
    """

    up: UpAxis | None = None
    metres_per_unit: (
        Annotated[float, msgspec.Meta(ge=LEAST_METRES_PER_UNIT, le=MOST_METRES_PER_UNIT)] | None
    ) = None
    position_m: Vector = (0.0, 0.0, 0.0)
    heading_deg: float = 0.0

    def check(self) -> None:
        """An axis, a length above 0, a point and an angle.

        Raises:
            UserError: a value is invalid.
        """
        if self.up is not None:
            checks.choice(self, "up", UP_AXES)
        if self.metres_per_unit is not None:
            checks.number(self, "metres_per_unit", LEAST_METRES_PER_UNIT, MOST_METRES_PER_UNIT)
        checks.numbers(self, "position_m", 3)
        if max(map(abs, self.position_m)) > _FARTHEST_M:
            checks.refuse(self, "position_m", f"lie within {_FARTHEST_M:.0e} m")
        checks.number(self, "heading_deg", -360.0, 360.0)

    def world_from_file(self) -> FloatArray:
        """The matrix (4, 4) from the file's axes and units to the world's, metres."""
        angle = math.radians(-self.heading_deg)
        c, s = math.cos(angle), math.sin(angle)
        turned = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        matrix = np.eye(4)
        matrix[:3, :3] = (self.metres_per_unit or 1.0) * turned @ _TO_Y_UP[self.up or "y"]
        matrix[:3, 3] = self.position_m
        return matrix


class PlacedFile(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A further scene file with its placement."""

    scene: str
    placement: Placement = Placement()

    def check(self) -> None:
        """A path and a placement."""
        checks.text(self, "scene")
        checks.instance(self, "placement", Placement)
        self.placement.check()

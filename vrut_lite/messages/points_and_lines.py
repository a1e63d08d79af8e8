"""Points and lines of a scene: seen one pixel wide, without light, shadow or reflection."""

import msgspec
import numpy as np

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.errors import UserError


class PointsAndLines(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Points and lines of a scene in world axes; colours are linear RGBA in [0, 1].

    Attributes:
        points_m: (P, 3) float64.
        point_rgba: (P, 4) float32.
        lines_m: (L, 2, 3) float64, the ends of each line.
        line_rgba: (L, 2, 4) float32, at its ends.
    """

    points_m: Array
    point_rgba: Array
    lines_m: Array
    line_rgba: Array

    def check(self) -> None:
        """Arrays of the types and shapes that are named above.

        Raises:
            UserError: an array is invalid.
        """
        checks.arrays(
            self,
            {
                "points_m": ("<f8", ("P", 3)),
                "point_rgba": ("<f4", ("P", 4)),
                "lines_m": ("<f8", ("L", 2, 3)),
                "line_rgba": ("<f4", ("L", 2, 4)),
            },
        )

    def check_arrays(self) -> None:
        """Places that are finite.

        Raises:
            UserError: an array is invalid.
        """
        if not all(np.isfinite(array.values).all() for array in (self.points_m, self.lines_m)):
            raise UserError("points and lines of a scene must stand at finite places")

"""A plane that cuts the scene in the picture; light, shadows and reflections ignore it."""

from typing import Literal, NamedTuple

import numpy as np

from vrut_lite import checks
from vrut_lite.kernel.messages import Derived
from vrut_lite.numeric_types import FloatArray, Vector

Axis = Literal["off", "x", "y", "z"]
Side = Literal["below", "above"]


class Section(NamedTuple):
    """Half space normal . p <= offset_m of visible points p; a unit normal in world axes."""

    normal: Vector
    offset_m: float

    def seen_part(self, eye_m: FloatArray, direction: FloatArray) -> tuple[float, float]:
        """Interval of a ray on the visible side, in metres; (inf, inf) if empty."""
        normal = np.array(self.normal)
        height, slope = self.offset_m - float(normal @ eye_m), float(normal @ direction)
        if slope == 0.0:
            return (0.0, np.inf) if height >= 0.0 else (np.inf, np.inf)
        crossing = height / slope
        if slope > 0.0:
            return (0.0, crossing) if crossing >= 0.0 else (np.inf, np.inf)
        return max(crossing, 0.0), np.inf


class SectionChanged(Derived, frozen=True, kw_only=True):
    """The present section plane, as `Section` has it; without a normal nothing is cut."""

    normal: Vector | None = None
    offset_m: float = 0.0

    @property
    def section(self) -> Section | None:
        """The plane; None where nothing is cut."""
        return None if self.normal is None else Section(self.normal, self.offset_m)

    def check(self) -> None:
        """A direction and a number."""
        if self.normal is not None:
            checks.direction(self, "normal")
        checks.number(self, "offset_m")


def section_of(axis: Axis, at_m: float, keeps: Side) -> Section | None:
    """The plane across an axis; `keeps` is its visible side."""
    if axis == "off":
        return None
    sign = 1.0 if keeps == "below" else -1.0
    x, y, z = (sign if name == axis else 0.0 for name in ("x", "y", "z"))
    return Section((x, y, z), sign * at_m)

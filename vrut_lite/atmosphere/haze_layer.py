"""Layers of haze that sunlight passes, as messages carry them."""

import msgspec

from vrut_lite import checks
from vrut_lite.numeric_types import Vector

# Wavelengths of their optical depths.
HAZE_NM = (680.0, 550.0, 440.0)
_MOST_HEIGHT_M, _MOST_DEPTH = 1e6, 1e4


class HazeLayer(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Aerosol above the ground that thins out exponentially.

    `optical_depth` is vertical, at `HAZE_NM`; `height_m` its scale height.
    """

    height_m: float
    optical_depth: Vector

    def check(self) -> None:
        """A height to divide by, and depths."""
        checks.number(self, "height_m", 1.0, _MOST_HEIGHT_M)
        checks.light(self, "optical_depth", _MOST_DEPTH)

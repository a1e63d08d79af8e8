"""The haze of the place; every sky follows it unless its settings override it.

A sky may have a setting `turbidity` that is none or a number: none follows the host's haze, a
number on Preetham's scale is that sky's own.
"""

from typing import get_args

from vrut_lite import checks
from vrut_lite.daylight.aerosol import (
    MOST_TURBIDITY,
    AerosolType,
    optical_depth_of_turbidity,
    turbidity_of_optical_depth,
)
from vrut_lite.daylight.tolerance import Remembers
from vrut_lite.kernel.messages import Input

OWN_HAZE = "turbidity"
# A dust storm has more, but no sky here reaches beyond turbidity 10.
MOST_OPTICAL_DEPTH = float(optical_depth_of_turbidity(MOST_TURBIDITY))
DEFAULT_TURBIDITY = 3.0


class SetHaze(Input, frozen=True, kw_only=True):
    """How much aerosol is above the place, and of which type.

    `optical_depth_550` is vertical, at 550 nm; turbidity is an alias on Preetham's scale, 3 is 0.20
    (`turbidity_of_optical_depth`).
    """

    optical_depth_550: float
    aerosol: AerosolType = "one-lobe"

    @property
    def turbidity(self) -> float:
        """The same on Preetham's scale."""
        return turbidity_of_optical_depth(self.optical_depth_550)

    def check(self) -> None:
        """A depth that every sky can show, of a known type."""
        checks.number(self, "optical_depth_550", 0.0, MOST_OPTICAL_DEPTH, of="haze")
        checks.choice(self, "aerosol", get_args(AerosolType))


# The default.
DEFAULT_HAZE = SetHaze(optical_depth_550=float(optical_depth_of_turbidity(DEFAULT_TURBIDITY)))


def haze_of(kernel: Remembers) -> SetHaze:
    """The haze that was set last."""
    return kernel.last(SetHaze) or DEFAULT_HAZE

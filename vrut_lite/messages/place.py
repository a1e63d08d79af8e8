"""The scene's place on Earth."""

from vrut_lite import checks
from vrut_lite.kernel.messages import Input

# No ground is lower; geostationary orbit is higher than any observer of an atmosphere needs.
LOWEST_M, HIGHEST_M = -11_000.0, 36_000_000.0
# A full turn, with room for rounding.
_TURN_RAD = 6.3


class SetPlace(Input, frozen=True, kw_only=True):
    """The observer's place; longitude is east-positive."""

    latitude_deg: float
    longitude_deg: float
    altitude_m: float = 0.0
    north_offset_rad: float = 0.0

    def check(self) -> None:
        """A place on or above the Earth."""
        checks.number(self, "latitude_deg", -90.0, 90.0, of="a place")
        checks.number(self, "longitude_deg", -180.0, 180.0, of="a place")
        checks.number(self, "altitude_m", LOWEST_M, HIGHEST_M, of="a place")
        checks.number(self, "north_offset_rad", -_TURN_RAD, _TURN_RAD, of="a place")

"""Which places there are: a place that is none must reach no module."""

from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import SetPlace

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

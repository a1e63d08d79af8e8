"""The moon's path over a place, with its rise and set."""

from datetime import datetime, timedelta
from typing import ClassVar

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.night import SLOT

_DAY_S = 86_400.0
_LONGEST_S = 10.0 * _DAY_S


class MoonPathChanged(Derived, frozen=True, kw_only=True):
    """The moon's place every `step_s` seconds from `start`, and when it rises and sets meanwhile.

    It reaches over every civil day that has begun somewhere. direction (n, 3) float32: apparent, in
    world axes; n is 0 where there is no night. `rises_s` and `sets_s`: of the refracted upper limb
    over a level horizon, in seconds since `start`.
    """

    slot: ClassVar[str | None] = SLOT

    start: datetime
    step_s: float
    direction: Array
    rises_s: tuple[float, ...]
    sets_s: tuple[float, ...]
    source: str

    def check(self) -> None:
        """Places at equal steps, and instants among them."""
        checks.instant(self, "start")
        checks.number(self, "step_s", 1.0, _DAY_S)
        checks.arrays(self, {"direction": ("<f4", ("places", 3))})
        for name in ("rises_s", "sets_s"):
            instants = getattr(self, name)
            if not (
                isinstance(instants, tuple)
                and all(checks.is_finite(s) and 0.0 <= s <= _LONGEST_S for s in instants)
            ):
                checks.refuse(self, name, "hold seconds since the start")
        checks.text(self, "source")

    def check_arrays(self) -> None:
        """Unit vectors."""
        if self.direction.shape[0]:
            checks.contents(self, "direction", -1.001, 1.001)

    def instants(self, seconds: tuple[float, ...]) -> list[datetime]:
        """Instants of seconds since the start."""
        return [self.start + timedelta(seconds=s) for s in seconds]

"""The tolerance, the largest relative error of radiance, and its use for sizes and thresholds.

A module's errors have several sources, each with a budget. A front is a measured list of choices
with errors and work; the choice of least work within the budget is taken.
"""

from pathlib import Path
from typing import Generic, Protocol, TypeVar

import msgspec

from vrut_lite import checks
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Input, Message


class SetTolerance(Input, frozen=True, kw_only=True):
    """The largest relative error of radiance: above 0, 1 at most.

    Sizes, orders of scattering and thresholds follow it, except named ones:
    99 of 100 directions of a picture stay within it (those darker than a thousandth of the
    brightest are measured by that).
    """

    tolerance: float

    def check(self) -> None:
        """A share above 0, and 1 at most."""
        if not (checks.is_finite(self.tolerance) and 0.0 < self.tolerance <= 1.0):
            raise UserError(
                "the tolerance must be above 0 and 1 (100 %) at most, not "
                f"{checks.shown(self.tolerance)}"
            )


# The default.
DEFAULT_TOLERANCE = 0.1

C = TypeVar("C")
M = TypeVar("M", bound=Message)


class Remembers(Protocol):
    """A kernel, or a module's link to one."""

    def last(self, message_type: type[M]) -> M | None:
        """The latest message of a type, or None."""


class Point(msgspec.Struct, Generic[C], frozen=True, forbid_unknown_fields=True):
    """One choice on a front.

    Attributes:
        choice: a size, or the name of several.
        error: largest error of 99 of 100 directions, in 99 of 100 pictures.
        work: counted work, comparable only within one front; less is better.
        cpu_ms: CPU time of that work on one thread, where it was measured.
    """

    choice: C
    error: float
    work: float
    cpu_ms: float


class MeasuredFronts(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A file of fronts: how many pictures, drawn from which seed, gave them."""

    module: str
    pictures: int
    seed: int
    fronts: dict[str, list[Point[int | str]]]


def read_fronts(path: Path) -> MeasuredFronts:
    """The fronts that a module brings."""
    return msgspec.json.decode(path.read_bytes(), type=MeasuredFronts)


def cheapest(front: list[Point[C]], allowed: float) -> C:
    """The choice of least work whose error is allowed; the most exact if none is."""
    able = [point for point in front if point.error <= allowed]
    if not able:
        return min(front, key=lambda point: point.error).choice
    return min(able, key=lambda point: point.work).choice


def budget(tolerance: float, usual: float, share: float) -> float:
    """The share of a tolerance for one source of error.

    Args:
        tolerance: tolerance of the whole picture.
        usual: budget at the default tolerance. A looser tolerance allows more in proportion; a
            tighter one as much, until that is more than the share.
        share: share of a tight tolerance for this source.
    """
    if tolerance >= DEFAULT_TOLERANCE:
        return usual * (tolerance / DEFAULT_TOLERANCE)
    return min(usual, share * tolerance)


def tolerance_of(kernel: Remembers) -> float:
    """The tolerance that was set last."""
    message = kernel.last(SetTolerance)
    return DEFAULT_TOLERANCE if message is None else message.tolerance

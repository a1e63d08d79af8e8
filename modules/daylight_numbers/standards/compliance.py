"""A row of a compliance page, and the words of its verdicts."""

from collections.abc import Sequence
from typing import NamedTuple

# Sums of areas leave rounding.
_ROUNDING = 1e-9


class Clause(NamedTuple):
    """A row: clause, subject, requirement, finding and verdict."""

    clause: str
    subject: str
    asks: str
    found: str
    verdict: str


def level_text(level: str) -> str:
    """The verdict of a level, "none" where none is reached."""
    return "fails" if level == "none" else f"meets {level}"


def met_text(is_met: bool) -> str:
    """The verdict of a single limit."""
    return "meets" if is_met else "fails"


def points_by_share(share: float, least: Sequence[float]) -> str:
    """The verdict of a share that earns a point for each limit that it reaches."""
    return points_text(sum(at_most(one, share) for one in least))


def points_text(count: int) -> str:
    """The verdict of so many points."""
    return "fails" if not count else f"{count} point{'s' if count > 1 else ''}"


def at_most(share: float, limit: float) -> bool:
    """Whether a share is at most a limit, but for rounding."""
    return share <= limit + _ROUNDING

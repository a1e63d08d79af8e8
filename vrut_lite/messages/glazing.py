"""Transmittance of panes, given by name of a scene's material."""

import math
from collections.abc import Callable
from typing import Annotated, Literal

import msgspec

Share = Annotated[float, msgspec.Meta(ge=0, le=1)]
# Refractive index of clear glass, and reflectance of one face at normal incidence.
IOR = 1.5
_FACE = ((IOR - 1.0) / (IOR + 1.0)) ** 2


class Glazing(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Transmittance of panes at normal incidence, times their colour in linear sRGB; the number of
    panes decides its fall towards grazing angles."""

    transmittance: Share
    colour: tuple[Share, Share, Share] = (1.0, 1.0, 1.0)
    panes: Annotated[int, msgspec.Meta(ge=1, le=4)] = 2


class GlazingFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Measured glazing: a Window XML file, and the vector that is up in it, world axes.

    A blind that moves has the states 0, `file`, and from 1 on `closed`, each darker than the one
    before. `by` says what moves it in a year: "schedule", a CSV file of states; "sun", direct
    illuminance on the pane from outdoors, state n from `sun_lx[n - 1]` on, by a sun that stands
    within `within_deg` of the pane's normal; "glare", the next one while DGP is above 0.40.
    """

    file: str
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    closed: tuple[str, ...] = ()
    by: Literal["", "schedule", "sun", "glare"] = ""
    schedule: str = ""
    sun_lx: tuple[float, ...] = ()
    within_deg: float = 90.0

    def __post_init__(self) -> None:
        length = math.hypot(*self.up)
        if not 0.0 < length < math.inf:
            raise ValueError(f"up is {self.up}: give a finite vector of some length")
        if bool(self.closed) != bool(self.by):
            raise ValueError(
                "a blind that moves has files in closed and a rule in by, schedule, sun or glare"
            )
        if (self.by == "schedule") != bool(self.schedule):
            raise ValueError("the rule schedule has a file in schedule, and no other rule has one")
        limits = self.sun_lx
        if len(limits) != (len(self.closed) if self.by == "sun" else 0):
            raise ValueError(
                f"the rule sun has a limit in sun_lx for each of {len(self.closed)} closed files, "
                "and no other rule has any"
            )
        rising = all(low < high for low, high in zip((0.0, *limits), limits, strict=False))
        if not rising or not all(map(math.isfinite, limits)):
            raise ValueError(f"sun_lx is {limits}: limits are above 0 and rise")
        if not 0.0 < self.within_deg <= 90.0:
            raise ValueError(f"within_deg is {self.within_deg:g}: give an angle up to 90 degrees")

    @property
    def states(self) -> tuple[str, ...]:
        """Files of all states, the open one first."""
        return (self.file, *self.closed)

    def with_paths(self, change: Callable[[str], str]) -> "GlazingFile":
        """The same with the paths of its files changed."""
        return msgspec.structs.replace(
            self,
            file=change(self.file),
            closed=tuple(map(change, self.closed)),
            schedule=self.schedule and change(self.schedule),
        )

    def in_state(self, state: int) -> "GlazingFile":
        """The glazing of one state, which does not move."""
        return GlazingFile(self.states[state], self.up)


def clear_at_right_angles(panes: int) -> float:
    """Transmittance of clear panes at normal incidence, with all reflections between them."""
    return (1.0 - _FACE) / (1.0 + (2 * panes - 1) * _FACE)

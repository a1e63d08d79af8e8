"""A year behind blinds that move: each hour has the light of the states that rules give its panes.

A state is a Window XML file of a material. Light of each combination of states that occurs is
computed for its own hours, all bounces included; hours are then put together (as in Radiance's
three-phase method with several transmission matrices, McNeil and Lee 2013).
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from light_transport.public import CancelCheck, always

from daylight_numbers.glare.eyes import Eyes
from daylight_numbers.glare.glare import glare_year
from daylight_numbers.matrix.measured_panes import MeasuredPanes
from daylight_numbers.report import Table
from daylight_numbers.state_schedule import read_schedule
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.metrics import OCCUPIED_H, occupied
from daylight_numbers.year.year import LUMENS_RGB, SolvedYear, Year, year_matrices, year_of
from daylight_numbers.year.year_light import YearLight
from vrut_lite.errors import UserError
from vrut_lite.messages.glazing import GlazingFile
from vrut_lite.numeric_types import Float32Array, FloatArray, IntArray
from vrut_lite.quantities import percent_text

# Each combination of states has its own year.
_MOST_COMBINATIONS = 16
_HOURS_AT_ONCE = 256
# EN 17037's medium level.
_MOST_DGP = 0.40


@dataclass(frozen=True, eq=False)
class PaneStates:
    """States (H,) of materials by their names in the hours of a year's light."""

    of: Mapping[str, IntArray]

    @property
    def combinations(self) -> tuple[IntArray, IntArray]:
        """Distinct rows (C, M) of states of all materials, and each hour's row (H,)."""
        rows, which = np.unique(
            np.stack(list(self.of.values()), axis=1), axis=0, return_inverse=True
        )
        return rows, which.reshape(-1)

    def some(self, chosen: IntArray) -> "PaneStates":
        """Those of some hours (H,)."""
        return PaneStates({name: states[chosen] for name, states in self.of.items()})


class StateLight(NamedTuple):
    """A scene in one combination of states, made ready, its bounces solved for `hours` of the year,
    and its eyes."""

    work: DaylightWork
    solved: SolvedYear
    hours: IntArray
    eyes: Eyes | None = None


LightOf = Callable[[Mapping[str, int]], StateLight]


def moves(bsdf: Mapping[str, GlazingFile]) -> bool:
    """Whether some blind moves."""
    return any(glazing.closed for glazing in bsdf.values())


def pane_states(
    panes: MeasuredPanes, bsdf: Mapping[str, GlazingFile], light: YearLight
) -> PaneStates:
    """The states of a year by the rules of materials that move.

    Raises:
        UserError: a schedule cannot be read.
    """
    found: dict[str, IntArray] = {}
    for name, glazing in bsdf.items():
        if glazing.by == "schedule":
            schedule = read_schedule(glazing.schedule, len(glazing.states))
            found[name] = schedule[light.hour]
        elif glazing.by == "sun":
            lux = sun_on_panes(panes, panes.materials.names.index(name), light, glazing.within_deg)
            found[name] = np.searchsorted(glazing.sun_lx, lux, side="right")
    return PaneStates(found)


def sun_on_panes(
    panes: MeasuredPanes, material: int, light: YearLight, within_deg: float = 90.0
) -> FloatArray:
    """Illuminance (H,) in lux of a material's panes by the direct sun, from outdoors.

    The mean over the panes that face one way; of several ways the one with most. What stands before
    panes shades them. Of hours whose sun stands farther than `within_deg` from the normal it is 0.
    """
    sun_lx = light.sun_irradiance_rgb @ LUMENS_RGB
    found = np.zeros(len(light.hour))
    for first in range(0, len(light.hour), _HOURS_AT_ONCE):
        some = slice(first, first + _HOURS_AT_ONCE)
        directions = light.sun_direction[some]
        sunlit = panes.sunlit(directions)
        for facet in np.flatnonzero(panes.tiles.glazing == material):
            cosine = -directions @ panes.tiles.axes[facet, 2]
            cosine[cosine < np.cos(np.radians(within_deg)) - 1e-9] = 0.0
            share = sunlit[panes.tiles.facet == facet].mean(axis=0)
            lux = share * np.maximum(cosine, 0.0) * sun_lx[some]
            found[some] = np.maximum(found[some], lux)
    return found


def moving_year(
    states: PaneStates,
    light: YearLight,
    light_of: LightOf,
    go_on: CancelCheck = always,
) -> Year:
    """A year at sensors whose panes change their states.

    Args:
        states: of the hours of `light`.
        light: the year's.
        light_of: makes a scene ready whose materials have these states.
        go_on: called between steps.

    Raises:
        UserError: too many combinations of states occur.
        GivenUp: by `go_on`.
    """
    parts = [
        (hours, year_of(year_matrices(of.work, some, solved, go_on), some))
        for hours, some, solved, of in _by_combination(states, light, light_of)
    ]
    return _joined(parts, len(light.hour))


def moving_glare(
    states: PaneStates, light: YearLight, light_of: LightOf, go_on: CancelCheck = always
) -> FloatArray:
    """DGP (P, H) of eyes behind panes that change their states; 0 outside 8:00 to 18:00.

    Raises:
        UserError: too many combinations of states occur.
        GivenUp: by `go_on`.
    """
    parts = []
    for hours, some, solved, of in _by_combination(states, light, light_of):
        assert of.eyes is not None
        parts.append((hours, glare_year(of.eyes.work, of.eyes.flats, some, solved, go_on)))
    found = np.zeros((len(parts[0][1]), len(light.hour)))
    for hours, dgp in parts:
        found[:, hours] = dgp
    return found


def states_by_glare(
    states: PaneStates, bsdf: Mapping[str, GlazingFile], light: YearLight, light_of: LightOf
) -> PaneStates:
    """The same with the materials whose rule is glare: in each hour from 8:00 to 18:00 they close
    together, state by state, while the DGP of an eye is above 0.40."""
    named = {name: len(one.states) for name, one in bsdf.items() if one.by == "glare"}
    if not named:
        return states
    chosen = np.zeros(len(light.hour), np.int64)
    above = np.flatnonzero(occupied(light))
    for state in range(max(named.values())):
        found = PaneStates(
            {
                **states.of,
                **{name: np.minimum(chosen, count - 1) for name, count in named.items()},
            }
        )
        if state == max(named.values()) - 1 or not len(above):
            break
        dgp = moving_glare(found.some(above), light.some(above), light_of)
        above = above[dgp.max(axis=0) > _MOST_DGP]
        chosen[above] = state + 1
    return found


def _by_combination(
    states: PaneStates, light: YearLight, light_of: LightOf
) -> Iterator[tuple[IntArray, YearLight, SolvedYear, StateLight]]:
    """For each combination its hours, their light and solved suns, and the scene in its states."""
    rows, which = states.combinations
    if len(rows) > _MOST_COMBINATIONS:
        raise UserError(
            f"bsdf: {len(rows)} combinations of states occur in the year: at most "
            f"{_MOST_COMBINATIONS} are computed; let some materials have fewer states"
        )
    for n, row in enumerate(rows):
        hours = np.flatnonzero(which == n)
        of = light_of(dict(zip(states.of, map(int, row), strict=True)))
        near = np.searchsorted(of.hours, light.hour[hours])
        yield hours, light.some(hours), of.solved.some(near), of


def _joined(parts: Sequence[tuple[IntArray, Year]], hours: int) -> Year:
    """A year (H) of years of some of its hours."""

    def join(of: Callable[[Year], Float32Array]) -> Float32Array:
        found = np.zeros((len(of(parts[0][1])), hours), np.float32)
        for some, year in parts:
            found[:, some] = of(year)
        return found

    return Year(
        join(lambda year: year.total),
        join(lambda year: year.sun),
        (join(lambda year: year.halves[0]), join(lambda year: year.halves[1])),
    )


def states_table(states: PaneStates, bsdf: Mapping[str, GlazingFile], light: YearLight) -> Table:
    """Share of 8:00 to 18:00 in which each state of a material is in use."""
    rows = []
    used = occupied(light)
    for name, of_hour in states.of.items():
        for state, file in enumerate(bsdf[name].states):
            count = int(np.count_nonzero(of_hour[used] == state))
            # Hours without any light are not among those of the light: blinds are open.
            count += OCCUPIED_H - int(np.count_nonzero(used)) if state == 0 else 0
            share = percent_text(count / OCCUPIED_H, 1)
            rows.append([name, f"{state}", Path(file).name, share, f"{count:,}"])
    columns = ["material", "state", "file", "share of hours", "hours"]
    return Table("Blinds that move, 8:00 to 18:00", columns, rows)


def method(bsdf: Mapping[str, GlazingFile]) -> list[str]:
    """A sentence on each blind that moves."""
    return [
        f"{name} has {len(one.states)} states by "
        + (
            f"the schedule {Path(one.schedule).name}."
            if one.by == "schedule"
            else "glare: closed while the DGP of an eye is above 0.40."
            if one.by == "glare"
            else "direct sun on its panes from outdoors: closed from "
            + ", ".join(f"{lux:,.0f}" for lux in one.sun_lx)
            + f" lx on, by a sun within {one.within_deg:g} degrees of the normal."
        )
        + " The hour, daylight factors and openings have its open state."
        for name, one in bsdf.items()
        if one.closed
    ]

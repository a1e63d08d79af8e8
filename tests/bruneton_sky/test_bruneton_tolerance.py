"""The Bruneton sky at a tolerance: what it chooses, what it keeps, what is made anew."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from bruneton_sky import Atmosphere
from bruneton_sky.module import BrunetonSky
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solver import SourceField, real_time_sizes
from bruneton_sky.solver_job import solve_air
from bruneton_sky.solver_rungs import (
    SOLVER_RUNGS,
    SolverRung,
    counted_work,
    rung_sizes,
    rung_tolerance,
)
from bruneton_sky.tolerance import FRONTS, TABLES, BrunetonQuality, quality_for
from bruneton_sky.unseen_moves import RADIANCE_TOLERANCE

from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE, SetTolerance, read_fronts
from vrut_lite.testing.sky_on_bus import SkyOnBus

GRID = np.geomspace(1e-4, 1.0, 81).tolist()
AIRS = {
    "clear": Atmosphere.earth(),
    "hazy": atmosphere_of(BrunetonSkySettings()),
    "fog": atmosphere_of(BrunetonSkySettings(fog_visibility_m=500.0)),
}


def test_the_default_is_unchanged() -> None:
    """The real-time sizes, the table and the steps that pictures and journals were made with before
    there was a tolerance."""
    assert quality_for(DEFAULT_TOLERANCE) == BrunetonQuality(
        "usual", "usual", 256, RADIANCE_TOLERANCE, 1.0
    )
    for air in AIRS.values():
        assert rung_sizes(air, "usual") == real_time_sizes(air)
    assert TABLES["usual"] == 1.0


def test_a_looser_tolerance_never_asks_for_more() -> None:
    """Over a grid of tolerances, knob by knob, in counted work."""
    chosen = [quality_for(tolerance) for tolerance in GRID]
    for tighter, looser in pairwise(chosen):
        for air in AIRS.values():
            of_looser, of_tighter = (
                counted_work(rung_sizes(air, quality.solver)) for quality in (looser, tighter)
            )
            assert of_looser <= of_tighter
        assert TABLES[looser.table] <= TABLES[tighter.table]
        assert looser.cube_size <= tighter.cube_size
        assert looser.sun_change >= tighter.sun_change
        assert looser.altitude_steps >= tighter.altitude_steps
    assert len({quality.solver for quality in chosen}) == len(SOLVER_RUNGS)


@pytest.mark.parametrize("name", AIRS)
def test_rungs_are_in_order(name: str) -> None:
    """Each takes more work than the one before, and ends its orders no sooner."""
    air = AIRS[name]
    work = [counted_work(rung_sizes(air, rung)) for rung in SOLVER_RUNGS]
    assert work == sorted(set(work))
    ends = [rung_tolerance(air, rung) for rung in SOLVER_RUNGS]
    assert ends == sorted(ends, reverse=True)


def test_fronts_fall() -> None:
    """More work brings less error, or a choice would be none."""
    for front in read_fronts(FRONTS).fronts.values():
        work, errors = ([getattr(p, name) for p in front] for name in ("work", "error"))
        assert work == sorted(work)
        assert errors == sorted(errors, reverse=True)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Rungs that atmospheres are solved at; all are solved as drafts: here counts who asks."""
    rungs: list[str] = []

    def draft(atmosphere: Atmosphere, orders: int, rung: str) -> SourceField:
        rungs.append(rung)
        return solve_air(atmosphere, orders, "draft")

    monkeypatch.setattr("bruneton_sky.module.solve_air", draft)
    return rungs


def test_a_tolerance_solves_the_air_again_and_names_the_size(asked: list[str]) -> None:
    """At the rung that it names, with as many texels; one of the same rung solves nothing."""
    sky = SkyOnBus(BrunetonSky)
    sky.want(BackgroundChanged)
    sky.sun(30.0)
    for tolerance in (DEFAULT_TOLERANCE, 0.01, 0.01):
        sky.tell(SetTolerance(tolerance=tolerance))
        size = sky.last(BackgroundChanged).cube.shape[1]  # type: ignore[union-attr]
        assert size == quality_for(tolerance).cube_size
    assert asked == ["usual", quality_for(0.01).solver]
    assert asked[1] != "usual"


@pytest.mark.parametrize("name", AIRS)
@pytest.mark.parametrize("rung", SOLVER_RUNGS)
def test_later_orders_have_no_more_azimuths_than_the_first(name: str, rung: SolverRung) -> None:
    """Their harmonics are added to those of the first order."""
    sizes = replace(rung_sizes(AIRS[name], rung), direction_azimuth=8)
    assert max(sizes.azimuths_of(order) for order in range(3, 9)) <= 8

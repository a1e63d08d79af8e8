"""The Bruneton sky's sizes and thresholds for a tolerance of radiance.

| knob | sizes | source |
|---|---|---|
| `solver` | nodes, directions, suns, bins, orders of an atmosphere's solution | front "solver" |
| `table` | rows, columns, steps and bins of the sky-view table | front "table" |
| `cube_size` | edge of the background's cube map where no consumer names one | front "cube_size" |
| `sun_change` | share by which the sun may change a texel unseen | `unseen_moves` and its test |
| `altitude_steps` | unseen moves of the eye, in steps of `unseen_moves` | proportion |

Orders of scattering never exceed the setting `orders`. The fronts are measured by
`vrut_lite_lab.tolerance_fronts`.
"""

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple, cast

from bruneton_sky.solver_rungs import SolverRung
from bruneton_sky.unseen_moves import RADIANCE_TOLERANCE
from vrut_lite.messages.tolerance import budget, cheapest, read_fronts

FRONTS = Path(__file__).parent / "data" / "tolerance_fronts.json"
# How many times as fine as usual a sky-view table is.
TABLES: Mapping[str, float] = MappingProxyType(
    {"coarse": 0.7, "usual": 1.0, "fine": 1.5, "finer": 2.0}
)
# Shares of the tolerance: errors seldom add up in one direction, so that solution and table get
# nearly all of it. At the default tolerance the budgets of table and cube map are less than their
# shares: the solution's error is smooth, theirs are edges that are seen.
_SOLVER_SHARE, _TABLE_SHARE, _CUBE_SHARE = 0.6, 0.5, 0.1
_USUAL_TABLE, _USUAL_CUBE = 0.01, 0.003


class BrunetonQuality(NamedTuple):
    """Sizes and thresholds; see the module's table."""

    solver: SolverRung
    table: str
    cube_size: int
    sun_change: float
    altitude_steps: float


@lru_cache(maxsize=16)
def quality_for(tolerance: float) -> BrunetonQuality:
    """The cheapest choices that keep a picture within a tolerance of radiance, a share above 0."""
    fronts = read_fronts(FRONTS).fronts
    return BrunetonQuality(
        solver=cast(SolverRung, cheapest(fronts["solver"], _SOLVER_SHARE * tolerance)),
        table=str(cheapest(fronts["table"], budget(tolerance, _USUAL_TABLE, _TABLE_SHARE))),
        cube_size=int(cheapest(fronts["cube_size"], budget(tolerance, _USUAL_CUBE, _CUBE_SHARE))),
        sun_change=budget(tolerance, RADIANCE_TOLERANCE, 0.05),
        altitude_steps=budget(tolerance, 1.0, 20.0),
    )

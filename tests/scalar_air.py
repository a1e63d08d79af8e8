"""Skies of scalar transfer, for truths that know no polarisation."""

from dataclasses import replace

from bruneton_sky import Atmosphere
from bruneton_sky.solved_sky import SolvedSky
from bruneton_sky.solver import MOST_ORDERS, SourceField, solve
from bruneton_sky.solver_rungs import rung_sizes, rung_tolerance


def scalar_field(atmosphere: Atmosphere, orders: int = MOST_ORDERS) -> SourceField:
    """`solver_job.solve_air` without Q and U."""
    sizes = replace(rung_sizes(atmosphere), polarised_orders=0)
    tolerance = rung_tolerance(atmosphere)
    return solve(atmosphere, orders, sizes, all_orders=True, tolerance=tolerance)


def scalar_sky(atmosphere: Atmosphere) -> SolvedSky:
    """`bruneton_sky.solve` without Q and U."""
    return SolvedSky(field=scalar_field(atmosphere))

"""Solves an atmosphere with the product's sizes: the module's background job, also for tests."""

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.solver import MOST_ORDERS, SourceField, solve
from bruneton_sky.solver_rungs import SolverRung, rung_sizes, rung_tolerance
from vrut_lite.errors import GivenUp
from vrut_lite.kernel.job import JobControl


def solve_air(
    atmosphere: Atmosphere,
    orders: int = MOST_ORDERS,
    rung: SolverRung = "usual",
    control: JobControl | None = None,
) -> SourceField:
    """All orders of scattering: so many computed at most, the rest as a geometric series.

    Raises:
        GivenUp: `control` was cancelled; asked after each order.
    """

    def tell(share: float) -> None:
        if control is not None:
            if control.cancelled():
                raise GivenUp
            control.progress(share)

    return solve(
        atmosphere,
        orders,
        rung_sizes(atmosphere, rung),
        all_orders=True,
        tolerance=rung_tolerance(atmosphere, rung),
        progress=tell,
    )

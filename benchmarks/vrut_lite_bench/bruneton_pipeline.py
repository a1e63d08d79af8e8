"""What the thesis's precomputation costs on the CPU, beside the fast solver, in the same run.

    python -m vrut_lite_bench.bruneton_pipeline

The plain float64 pipeline runs on a few altitudes, with every other axis at its full size, and
each of its steps is EXTRAPOLATED to the full sizes by nodes times samples. The fast solver runs
at the full sizes. One thread, CPU time; of the solver the least of some rounds. Set
OPENBLAS_NUM_THREADS=1. It takes about a minute. A whole run of the pipeline took 233 s of CPU
on a machine for which this said 206 s.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.precompute import irradiance_table, march_tables
from bruneton_sky.reference.pipeline import setting
from bruneton_sky.reference.pipeline.pipeline import run_pipeline
from bruneton_sky.solver import solve
from bruneton_sky.tables.sizes import TableSizes
from numpy.typing import NDArray

ORDERS = 4
FULL = TableSizes()
# Fewer altitudes make arrays below 4 MB, for which numpy asks the system for no huge pages: each
# node then costs up to 1.7 times as much.
FEW = replace(FULL, altitude=8, transmittance_altitude=16, irradiance_altitude=4)
ROUNDS = 10
# The first orders of scattering cost more than the later ones, which cost the same each.
_ORDERS_TIMED = 3


class Step(NamedTuple):
    """Seconds measured on few nodes, and how many times the work at the full sizes is."""

    name: str
    order: int
    measured_s: float
    samples: int
    times_as_much: float

    @property
    def full_s(self) -> float:
        """Extrapolated."""
        return self.measured_s * self.times_as_much


def pipeline_steps(atmosphere: Atmosphere) -> list[Step]:
    """Every step of the plain pipeline with `ORDERS` orders, from a run on few nodes."""
    steps = _run_on_few_nodes(atmosphere)
    later = [step for step in steps if step.order == _ORDERS_TIMED]
    return steps + [
        step._replace(order=order)
        for order in range(_ORDERS_TIMED + 1, ORDERS + 1)
        for step in later
    ]


def _run_on_few_nodes(atmosphere: Atmosphere) -> list[Step]:
    steps: list[Step] = []
    before = time.process_time()

    def note(name: str, order: int, array: NDArray[np.float64]) -> None:
        nonlocal before
        spent = time.process_time() - before
        samples, nodes = _work(name, order)
        steps.append(Step(name, order, spent, samples, nodes(FULL) / nodes(FEW)))
        before = time.process_time()

    run_pipeline(atmosphere, FEW, _ORDERS_TIMED, observe=note)
    return steps


def solver_seconds(atmosphere: Atmosphere) -> float:
    """The fast solver: source function, and the tables of the full sizes."""

    def run() -> None:
        field = solve(atmosphere, orders=ORDERS)
        march_tables(field, FULL)
        irradiance_table(field, FULL)

    run()
    least = float("inf")
    for _ in range(ROUNDS):
        start = time.process_time()
        run()
        least = min(least, time.process_time() - start)
    return least


def report(steps: list[Step], solver_s: float) -> Iterator[str]:
    """A Markdown table, and the ratio."""
    yield "| plain pipeline | order | samples | few nodes, s, measured | full, s, EXTRAPOLATED |"
    yield "|---|---:|---:|---:|---:|"
    for step in steps:
        yield (
            f"| {step.name} | {step.order} | {step.samples} | {step.measured_s:.3f} "
            f"| {step.full_s:.1f} |"
        )
    plain_s = sum(step.full_s for step in steps)
    yield f"plain pipeline, {ORDERS} orders, full sizes, EXTRAPOLATED: {plain_s:.0f} s of CPU"
    yield f"fast solver, {ORDERS} orders, full sizes, measured: {solver_s:.3f} s of CPU"
    yield f"the fast solver is {plain_s / solver_s:.0f} times faster (by the extrapolation)"


def _work(name: str, order: int) -> tuple[int, Callable[[TableSizes], int]]:
    """Samples taken at each node, and the number of nodes, of a step."""
    zenith, sky = setting.DENSITY_ZENITH_ANGLES, setting.IRRADIANCE_ZENITH_ANGLES
    if name == "transmittance":
        return setting.TRANSMITTANCE_INTERVALS + 1, _transmittance_nodes
    if name == "delta_irradiance":
        return (1 if order == 1 else sky * sky), _irradiance_nodes
    if name == "scattering_density":
        return 2 * zenith * zenith, _scattering_nodes
    # Aerosol's table is made in the same pass as the molecules', before which nothing is noted.
    return setting.RAY_INTERVALS + 1, _scattering_nodes


def _transmittance_nodes(sizes: TableSizes) -> int:
    return sizes.transmittance_altitude * sizes.transmittance_mu


def _irradiance_nodes(sizes: TableSizes) -> int:
    return sizes.irradiance_altitude * sizes.irradiance_mu_s


def _scattering_nodes(sizes: TableSizes) -> int:
    return int(np.prod(sizes.scattering_shape))


def main() -> None:
    """Print the table."""
    atmosphere = Atmosphere.earth()
    solver_s = solver_seconds(atmosphere)
    for line in report(pipeline_steps(atmosphere), solver_s):
        print(line)


if __name__ == "__main__":
    main()

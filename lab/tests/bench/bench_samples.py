"""Measured paths and runs with known numbers."""

from vrut_lite_lab.bench.results import FORMAT, Errors, GroupNote, Machine, MeasuredPath, Results

MACHINE = Machine(
    date="2026-11-21 12:00 UTC",
    processor="a processor",
    cores=2,
    system="a system",
    renderer="llvmpipe",
    versions={"numpy": "2.4"},
    load_before=(1.0, 1.0, 1.0),
    load_after=(2.0, 1.5, 1.0),
    pace_s=1e-4,
)


def measured(
    name: str, rounds_s: list[float], p99: float = 0.01, mean: float = 0.001
) -> MeasuredPath:
    """A path of the group "sky" whose errors by day are these, and twice as large by night."""
    errors = {
        "sun 10°, 0 m up": Errors(mean, p99, 2 * p99),
        "sun -4°, 0 m up": Errors(2 * mean, 2 * p99, 4 * p99),
    }
    return MeasuredPath(
        group="sky",
        name=name,
        family=name.split(",")[0],
        device="CPU",
        parameters={"size": 4},
        clock="CPU time of the process",
        rounds_s=rounds_s,
        wall_s=min(rounds_s),
        errors=errors,
    )


def run_of(*paths: MeasuredPath, machine: Machine = MACHINE, quick: bool = True) -> Results:
    """A run that measured these."""
    return Results(
        format=FORMAT,
        quick=quick,
        kinds=["sun"],
        machine=machine,
        spent_s=3.0,
        groups=[GroupNote("sky", "A sky", "a sky", "relative", "float64", "")],
        paths=list(paths),
        left_out={"mitsuba": "is not installed"},
    )
